import pytest

from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.sampling import Sampling


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ({"ni": 1}, "res: ni = 1; use 2 to"),
        ({"nj": 10**7}, "res: nj = 10000000; use"),
        ({"topology": "h"}, "topology 'h' is not known; use auto/quad/o/c"),
        ({"spacing": "log"}, "spacing 'log' is not known; use auto/"),
        ({"le_spacing": 0.0}, "le_spacing: 0 chords; use 1e-9 to 0.2"),
        ({"te_spacing": 1e-300}, "te_spacing: 1e-300 chords; use 1e-9 to 0.2"),
        ({"te_spacing": 0.5}, "te_spacing: 0.5 chords"),
        ({"far_field": float("nan")}, "far_field: nan is no distance"),
        ({"corners": (0, 1, 1, 2)}, "not four different points"),
    ],
)
def test_settings_out_of_range_are_refused_with_the_range(setting, message):
    with pytest.raises(InputError, match=message):
        Sampling(**setting)


def test_a_far_field_of_a_body_is_outside_of_it() -> None:
    with pytest.raises(InputError, match="far_field: 1 chords; use more than 1"):
        _ = Sampling(far_field=1.0).radius
