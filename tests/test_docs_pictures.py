"""Pictures in the documents are those of the commands above them."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
spec = importlib.util.spec_from_file_location("docs_pictures", BENCHMARKS / "docs_pictures.py")
docs_pictures = importlib.util.module_from_spec(spec)
spec.loader.exec_module(docs_pictures)


def pixels(path):
    """Grey levels, averaged over tiles of 10 x 10."""
    from matplotlib.image import imread

    grey = imread(path)[..., :3].mean(axis=-1)
    rows, columns = (n // 10 * 10 for n in grey.shape)
    return grey[:rows, :columns].reshape(rows // 10, 10, columns // 10, 10).mean(axis=(1, 3))


@pytest.mark.slow
@pytest.mark.parametrize("name", docs_pictures.PICTURES)
def test_a_picture_is_what_its_command_draws(tmp_path, name):
    """Tiles differ where the picture is an old one; fonts and versions move less than that."""
    made = pixels(docs_pictures.make(name, tmp_path))
    shown = pixels(docs_pictures.ROOT / "docs" / "images" / f"{name}.png")
    assert made.shape == shown.shape
    assert np.mean(np.abs(made - shown) > 0.1) < 0.02
