"""What every format of frame files must do: one suite that each of them inherits."""

from abc import ABC, abstractmethod

import numpy as np
import pytest

from spinline.base.errors import InputError
from spinline.images.formats import open_file
from spinline.images.stacks import open_stack

FRAMES = np.random.default_rng(3).integers(50, 4000, (7, 20, 33)).astype(np.uint16)


class FrameReaderContract(ABC):
    """Inherit, and say how a file of frames is written."""

    suffix = ""
    single = False  # a file holds one frame

    @abstractmethod
    def write(self, path, frames):
        """Write frames (frame, row, column) to a path."""

    @pytest.fixture
    def frames(self):
        return FRAMES[:1] if self.single else FRAMES

    @pytest.fixture
    def file(self, tmp_path, frames):
        path = tmp_path / f"frames{self.suffix}"
        self.write(path, frames)
        return path

    def test_all_frames_in_their_order(self, file, frames) -> None:
        stack = open_stack(file.name, "counts", file.parent)
        assert (stack.frames, stack.rows, stack.columns) == frames.shape
        assert np.array_equal(stack.read(0, stack.frames), frames)

    def test_a_part_is_a_part_of_the_whole(self, file, frames) -> None:
        stack = open_stack(file.name, "counts", file.parent)
        for start, stop in ((0, 1), (len(frames) // 2, len(frames)), (len(frames) - 1, len(frames)), (0, len(frames))):
            assert np.array_equal(stack.read(start, stop), frames[start:stop])

    def test_turned_cut_and_picked(self, file, frames) -> None:
        turned = open_stack(file.name, "counts", file.parent, transpose=True)
        assert np.array_equal(turned.read(0, 1)[0], frames[0].T)
        cut = open_stack(file.name, "counts", file.parent, roi=(slice(2, 9), slice(5, 30)))
        assert np.array_equal(cut.read(0, 1)[0], frames[0, 2:9, 5:30])
        if not self.single:
            some = open_stack(file.name, "counts", file.parent, frames=slice(1, 6, 2))
            assert np.array_equal(some.read(0, 3), frames[1:6:2])

    def test_its_account_names_the_file(self, file) -> None:
        reader = open_file(file, None, "counts")
        assert file.name in reader.account.source
        assert reader.account.missing == ()
        assert len(reader.shape) == 3
        assert reader.read(0, 1).dtype == reader.dtype

    def test_a_file_cut_short_is_refused_by_its_name(self, file) -> None:
        whole = file.read_bytes()
        for part in (len(whole) // 2, 40, 0):
            file.write_bytes(whole[:part])
            with pytest.raises(InputError, match="counts"):
                open_stack(file.name, "counts", file.parent).read(0, 1 if self.single else len(FRAMES))

    def test_many_files_are_one_stack(self, tmp_path, frames) -> None:
        for i in (10, 2, 1):
            self.write(tmp_path / f"part_{i}{self.suffix}", frames + i)
        stack = open_stack(f"part_*{self.suffix}", "counts", tmp_path)
        assert np.array_equal(stack.read(0, stack.frames), np.concatenate([frames + 1, frames + 2, frames + 10]))
        assert stack.source(0).startswith("part_1.")
        assert stack.source(stack.frames - 1).startswith("part_10.")
