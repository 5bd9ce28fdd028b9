"""A parameter that is set on the FMU makes the cable that one would have built with that value."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.conftest import Unpacked
from tests.fmu_helpers import KINDS, Host, levered, small_scene, unpack, with_parameters

CASES = [(kind, name) for kind in KINDS for name in small_scene(kind).cable.parameters]


def driven(host: Host, **values: float) -> Host:
    return host.initialize(**levered(host.reference, {"u_m1": 800.0}), **values)


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize(("kind", "name"), CASES)
def test_setting_is_building(kind: str, name: str, fmi: int, unpacked: Unpacked, tmp_path: Path) -> None:
    scene = small_scene(kind)
    changed = 1.25 * scene.cable.parameters[name] + 0.5
    with Host(unpacked(kind, fmi)) as host:
        default = driven(host).run(1.0)
    with Host(unpacked(kind, fmi)) as host:
        was_set = driven(host, **{name: changed}).run(1.0)
    with Host(unpack(with_parameters(scene, **{name: changed}), tmp_path, fmi)) as host:
        was_built = driven(host).run(1.0)
    # The same numbers by two ways: rounding has no place to differ.
    np.testing.assert_allclose(was_set, was_built, rtol=1e-12)
    assert np.max(np.abs(was_set - default)) > 1e-6


def test_every_parameter_of_the_table_is_among_them() -> None:
    from cablefmu.fmu.table import table

    assert {name for _, name in CASES} == set(table().parameters)


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_start_values_are_those_of_the_description(kind: str, fmi: int, unpacked: Unpacked) -> None:
    with Host(unpacked(kind, fmi)) as host:
        given = {v.name: float(v.start) for v in host.description.modelVariables if v.start is not None}
        assert host.get(*given) == list(given.values())
