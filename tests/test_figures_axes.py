"""Every figure draws into axes that a caller gives, and into as many as it has panels."""

import pytest
from matplotlib.figure import Figure

import spinline as sl
from spinline.base.errors import InputError
from spinline.report.figures import figure
from spinline.report.style import save_sheet
from spinline.report.window_figure import window_figure
from spinline.study.window import operating_window


@pytest.fixture(scope="module")
def result():
    return sl.run(sl.load_scene("peo5-water"))


def test_a_run_is_drawn_where_the_caller_wants(result):
    sheet = Figure()
    axes = sheet.subplots(2, 3)
    assert figure(result, axes.ravel()[[0, 1, 3, 4]]) is sheet
    drawn = [len(axis.lines) for axis in axes.flat]
    assert all(drawn[i] for i in (0, 1, 3, 4))
    assert drawn[2] == drawn[5] == 0
    assert sheet.get_suptitle() == ""


def test_a_window_is_drawn_where_the_caller_wants():
    scene = sl.load_scene("peo5-water", ["network.model=affine"])
    found = operating_window(scene, voltage=[5e3, 1e4, 2e4], gap=0.15, conductivity=0.01, relative_humidity=0.4)
    sheet = Figure()
    axes = sheet.subplots(1, 4)
    assert window_figure(found, axes) is sheet
    assert all(axis.lines for axis in axes)


@pytest.mark.parametrize("count", [1, 3, 5])
def test_another_number_of_axes_is_refused(result, count):
    axes = Figure().subplots(1, count, squeeze=False)
    with pytest.raises(InputError, match=r"axes.*2 x 2 panels"):
        figure(result, axes)


def test_axes_that_are_none_are_refused(result):
    with pytest.raises(InputError, match="axes"):
        figure(result, ["a", "b", "c", "d"])


@pytest.mark.parametrize("name", ["a.png", "a.pdf", "a.svg"])
def test_sheets_are_written_in_every_format(result, tmp_path, name):
    file = save_sheet(figure(result), tmp_path / name)
    assert file.stat().st_size > 1000
