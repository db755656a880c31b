"""Bodies and wings of aircraft that are patches of a surface file: which are taken, what is changed."""

from pathlib import Path

import numpy as np
import pytest
from aircraft_surfaces import LENGTH, RADIUS, SPAN, TOML, body_patch, radius, wing_patches, written

from meshonet.formats.stack import stack_of
from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.aircraft.surface_wing import SurfaceWing
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError


def read(folder: Path, patches: list[Floats], text: str = TOML) -> Aircraft:
    written(folder / "jet.xyz", patches)
    (folder / "jet.toml").write_text(text)
    jet = stack_of(str(folder / "jet.toml"))
    assert isinstance(jet, Aircraft)
    return jet


def wing_of(jet: Aircraft) -> SurfaceWing:
    assert isinstance(jet.wing, SurfaceWing)
    return jet.wing


def test_body_and_wing_are_told_apart_by_the_plane_of_symmetry(tmp_path: Path) -> None:
    upper, lower = wing_patches()
    jet = read(tmp_path, [lower, body_patch(), upper])
    assert jet.notes == ("the fuselage is patch 1 of jet.xyz; y points up, and the half is that of z >= 0",)
    assert wing_of(jet).notes == ("the wing is patch 0, 2 of jet.xyz",)
    x, r = jet.body.meridian.T
    assert np.abs(r - radius(x)).max() < 1e-9
    assert jet.wing.chord == pytest.approx(2.0 - 0.3 / SPAN, rel=1e-3)
    assert jet.wing.end == pytest.approx((5.4, 0.25, SPAN), abs=1e-3)


def test_patches_may_be_chosen(tmp_path: Path) -> None:
    rows = 'kind = "aircraft"\n[[bodies]]\nsurface = "jet.xyz"\npatches = [2]\n'
    rows += '[[wings]]\nname = "left"\nsurface = "jet.xyz"\npatches = [0, 1]\n'
    jet = read(tmp_path, [*wing_patches(begin=0.0), body_patch()], rows)
    assert wing_of(jet).name == "left"
    with pytest.raises(InputError, match="7 is no patch of the file; use 0 to 2"):
        read(tmp_path, [*wing_patches(), body_patch()], rows.replace("[2]", "[7]"))


@pytest.mark.parametrize("turn", ["reversed", "transposed", "one", "with a base"])
def test_patches_may_run_either_way(tmp_path: Path, turn: str) -> None:
    upper, lower = wing_patches()
    patches = {
        "reversed": [lower[::-1, ::-1], upper[:, ::-1]],
        "transposed": [upper.swapaxes(0, 1), lower],
        "one": [np.concatenate([upper, lower[:, 1:]], axis=1)],
        "with a base": [lower, np.stack([lower[:, -1], upper[:, 0]], axis=1), upper],
    }[turn]
    same, own = (
        wing_of(read(tmp_path, [body_patch(), upper, lower])),
        wing_of(read(tmp_path, [body_patch(), *patches])),
    )
    z = np.array([1.0, 4.0])
    for one, other in zip(own.edges(z), same.edges(z), strict=True):
        assert one == pytest.approx(other, abs=1e-12)
    assert own.base(z) == pytest.approx(same.base(z))


def test_a_tip_that_closes_is_cut_off(tmp_path: Path) -> None:
    wing = wing_of(read(tmp_path, [body_patch(), *wing_patches(closing=True)]))
    assert SPAN <= wing.height < SPAN + 0.05
    assert "the tip of the wing is flat, where its thickness begins to shrink" in wing.notes[1]


def test_a_body_without_a_tail_gets_a_cap(tmp_path: Path) -> None:
    jet = read(tmp_path, [body_patch(end=8.0), *wing_patches()])
    end = 0.5 * LENGTH * (1.0 - np.cos(np.pi * 84 / 120))
    assert jet.body.meridian[-1, 0] == pytest.approx(end + radius(np.array([end]))[0])
    assert "the fuselage has no point at its tail, x=7.9389" in jet.notes[1]
    x = np.linspace(0.5, end, 50)
    assert np.abs(jet.body.meridional(jet.body.arc_at(x))[:, 1] - radius(x)).max() < 1e-3


def test_a_corner_of_a_body_does_not_bulge(tmp_path: Path) -> None:
    body = body_patch()
    cone = np.clip((LENGTH - body[..., :1]) / (LENGTH - body[0, 76, 0]), 0.0, 1.0)  # 11 degrees steep
    body[..., 1:] = RADIUS * cone * np.stack([-np.cos(a := np.linspace(0, np.pi, 13)), np.sin(a)], 1)[:, None]
    body[:, :20, 1:] *= np.sqrt(1.0 - (1.0 - body[:, :20, :1] / body[0, 20, 0]) ** 2)
    jet = read(tmp_path, [body, *wing_patches()])
    x = np.linspace(4.0, 9.9, 400)
    stations = body[0, :, 0], np.hypot(body[0, :, 1], body[0, :, 2])
    assert (
        np.abs(jet.body.meridional(jet.body.arc_at(x))[:, 1] - np.interp(x, *stations)).max() < 2e-5 * LENGTH
    )


@pytest.mark.parametrize(
    ("patches", "message"),
    [
        ([body_patch(keel=0.2), *wing_patches()], "a hole or a side without a neighbour at x="),
        ([body_patch(), wing_patches()[0]], "a patch of the wing ends .* chords from the next one, at x="),
        ([body_patch() * [1, 1, -1], *wing_patches()], "lies on both sides of y=0 and of z=0"),
        ([body_patch()], "all patches have a side in the plane of symmetry"),
        (wing_patches(), "no patch has a side in the plane of symmetry"),
    ],
)
def test_other_surfaces_are_refused_with_the_place(
    tmp_path: Path, patches: list[Floats], message: str
) -> None:
    with pytest.raises(InputError, match=message) as caught:
        read(tmp_path, patches)
    assert caught.value.place in ("bodies[0].surface", "wings[0].surface")
    assert caught.value.problem
    assert caught.value.remedy


def test_thin_trailing_edges_of_surfaces_are_opened_only_where_asked(tmp_path: Path) -> None:
    wing = wing_of(read(tmp_path, [body_patch(), *wing_patches()]))
    z = np.array([1.0, 3.0])
    assert wing.opened(0.001) is wing
    thicker = wing.opened(0.01)
    assert thicker.base(z) == pytest.approx(0.01, rel=1e-2)
    assert thicker.notes[-1] == "the trailing edge of the wing, 0.0031 chords high, is opened to 0.01 chords"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (TOML.replace("jet", "none", 1), r"bodies\[0\].surface: .*no such file"),
        (TOML.replace('"jet.xyz"', "3", 1), r"bodies\[0\].surface: 3 is no text"),
        (TOML + "patches = [true]", r"wings\[0\].patches: True is no patch of the file; use 0 to 2"),
        (TOML + "patches = []", r"wings\[0\].patches: is no list of numbers or names"),
        (TOML + "sections = 3", r"wings\[0\].sections: is not known; use on, name, surface, patches"),
        (TOML + 'on = "hull"', r"wings\[0\].on: hull is no body; use fuselage"),
    ],
)
def test_wrong_keys_and_values_are_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(tmp_path, [body_patch(), *wing_patches()], text)


def test_a_wing_may_be_a_surface_on_a_body_with_a_meridian(tmp_path: Path) -> None:
    meridian = [[x, float(radius(np.array(x)))] for x in (0.0, 1.0, 3.0, 7.0, 10.0)]
    wings = TOML[TOML.index("[[wings]]") :]
    jet = read(tmp_path, wing_patches(), f'kind = "aircraft"\n[[bodies]]\nmeridian = {meridian}\n{wings}')
    assert wing_of(jet).notes == ("the wing is patch 0, 1 of jet.xyz",)
