"""One meaning, one colour, in recordings and on the page (Okabe and Ito 2008, told apart by colour-blind readers)."""

ORANGE = "#E69F00"
SKY = "#56B4E9"
GREEN = "#009E73"
YELLOW = "#F0E442"
BLUE = "#0072B2"
VERMILLION = "#D55E00"
PURPLE = "#CC79A7"
GREY = "#8A94A0"
WHITE = "#F4F6F8"
NIGHT, NIGHT_LINES, NIGHT_GRID = "#14181D", "#46525F", "#2B333C"  # background of the viewer, and lines that must stay behind the rest

OWN = SKY  # the aircraft, its velocity, the trail it has flown
OBSTACLE = VERMILLION  # the spheres and what is forbidden because of them
COMMAND = PURPLE  # what the method asks for: velocity, insertion point
ALARM = "#FF4B4B"  # inside a sphere: a collision
RELATIVE = "#E8D8FF"  # velocities and cone as seen from the obstacle
LIGHT = "#FFC9A8"  # words on the obstacle's colour
AIR = "#9FE8DC"  # the air: wind, velocity through it
LEG = {"route": GREY, "avoid": YELLOW, "rejoin": GREEN}


def rgba(colour: str, alpha: float = 1.0) -> tuple[int, int, int, int]:
    """``#RRGGBB`` as four bytes."""
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return red, green, blue, round(255 * alpha)


def dimmed(colour: str, share: float = 0.45) -> str:
    """A colour as it would be half seen through on the viewer's background, which does not mix the colours of lines."""
    parts = [(int(colour[k : k + 2], 16), int(NIGHT[k : k + 2], 16)) for k in (1, 3, 5)]
    return "#" + "".join(f"{round(share * front + (1.0 - share) * back):02X}" for front, back in parts)
