"""A scene of one jet laid on a plate, shared by tests of commands."""


def lay_text(time: str = "1 ms") -> str:
    """The scene, for a time of laying."""
    return f"""title = "One jet"
[laydown]
speed = "5 m/s"
spread = "60 um"
turning_length = "100 um"
diameter = "600 nm"
[collector]
distance = "20 cm"
time = "{time}"
[mat]
window = "12 um"
realisations = 1
"""
