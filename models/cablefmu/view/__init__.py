"""The moving cable: one HTML page that plays a result, or a movie of it."""

from .motion import Motion, motion_of
from .movie import MOVIES, check_movie, write_movie
from .page import check_page, view_page, write_page
from .write import SUFFIXES, check_view, write_view

__all__ = [
    "MOVIES", "SUFFIXES", "Motion", "check_movie", "check_page", "check_view", "motion_of", "view_page", "write_movie",
    "write_page", "write_view",
]  # fmt: skip
