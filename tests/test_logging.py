"""What a run decides is told to the logger `spinline`, and to nobody who does not ask."""

import logging

import spinline as sl


def test_the_choice_is_logged(caplog):
    with caplog.at_level(logging.DEBUG, logger="spinline"):
        result = sl.run(sl.load_scene("peo5-water"))
    assert any("peo5-water" in record.getMessage() and record.levelname == "INFO" for record in caplog.records)
    assert str(result.attrs["model"]) in caplog.text


def test_nothing_is_printed_by_itself(capsys):
    sl.run(sl.load_scene("peo5-water"))
    assert capsys.readouterr() == ("", "")
