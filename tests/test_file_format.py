"""Files carry the number of their format; a newer one is refused by name."""

import json

import h5py
import numpy as np
import pytest

import spinline as sl
from spinline.base import file_format, netcdf
from spinline.base.errors import InputError
from spinline.deposit.fibres import FibreFile, FibreWriter
from spinline.solve.results import open_result, save
from spinline.study import store as stores


@pytest.fixture
def newer(monkeypatch):
    """What writes is one format ahead of what reads."""

    def written(*modules):
        for module in modules:
            monkeypatch.setattr(module, "FORMAT", file_format.FORMAT + 1)

    return written


def test_a_result_says_its_format_and_a_newer_one_is_refused(tmp_path, newer):
    result = sl.run(sl.load_scene("peo5-water"))
    save(result, tmp_path / "a.nc")
    with h5py.File(tmp_path / "a.nc") as file:
        assert file.attrs["spinline_format"].tolist() == [1]
    assert open_result(tmp_path / "a.nc").attrs == result.attrs
    newer(netcdf)
    save(result, tmp_path / "b.nc")
    with pytest.raises(InputError, match=r"b\.nc: was written in format 2,.*allowed: format 1 to 1.*newer"):
        open_result(tmp_path / "b.nc")


@pytest.mark.parametrize("found", ["x", 0, -1, 1.5e9, [1, 2], float("nan"), b"\xff"])
def test_a_number_that_is_none_is_refused(found):
    with pytest.raises(InputError, match="format"):
        file_format.require_format("a.nc", found)


@pytest.mark.parametrize("found", [None, 1, np.int64(1)])
def test_today_and_none_are_read(found):
    file_format.require_format("a.nc", found)


def test_a_store_of_a_newer_version_is_refused(tmp_path, spinline, newer):
    (tmp_path / "s.toml").write_text('scene = "peo5-water"\n[vary]\njet.k = [1, 2]\n', "utf-8")
    newer(stores)
    ran = spinline("sweep", "s.toml", "-o", "s.zarr")
    assert json.loads((tmp_path / "s.zarr" / "zarr.json").read_text("utf-8"))["attributes"]["spinline_sweep"] == 2
    assert ran.code == 2
    assert "format 1 to 1" in ran.err
    with pytest.raises(InputError, match="does not know"):
        stores.open_sweep(tmp_path / "s.zarr")


def test_fibres_of_a_newer_version_are_refused(tmp_path, newer):
    from spinline.deposit import fibres

    newer(fibres)
    with FibreWriter(tmp_path / "f.h5"):
        pass
    with pytest.raises(InputError, match="does not know"):
        FibreFile(tmp_path / "f.h5")
