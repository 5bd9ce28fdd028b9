"""Formulas: what each command becomes, and that mistakes in them are seen."""

from __future__ import annotations

import pytest
from lxml import etree

from cablefmu.fmu.equations import equations_of
from cablefmu.fmu.mathml import mathml
from cablefmu.fmu.variables import variables_of
from tests.fmu_helpers import KINDS, small_scene

BAR = '<mo stretchy="false" lspace="0" rspace="0">|</mo>'
CHILDREN = {"msub": 2, "msup": 2, "msubsup": 3, "munder": 2, "mover": 2, "munderover": 3, "mfrac": 2}
"""How many MathML asks for."""


@pytest.mark.parametrize(
    ("tex", "content"),
    [
        ("a + 2.5", "<mi>a</mi><mo>+</mo><mn>2.5</mn>"),
        ("-θ_i", "<mo>−</mo><msub><mi>θ</mi><mi>i</mi></msub>"),
        ("k_{m1}^2", "<msubsup><mi>k</mi><mrow><mi>m</mi><mn>1</mn></mrow><mn>2</mn></msubsup>"),
        ("x^2", "<msup><mi>x</mi><mn>2</mn></msup>"),
        (r"\frac{1}{n}", "<mfrac><mrow><mn>1</mn></mrow><mrow><mi>n</mi></mrow></mfrac>"),
        (r"\sum_i x", "<munder><mo>∑</mo><mi>i</mi></munder><mi>x</mi>"),
        (r"\ddot{x}", '<mover><mrow><mi>x</mi></mrow><mo stretchy="false">..</mo></mover>'),
        (r"\vec{P}_n", '<msub><mi class="vector">P</mi><mi>n</mi></msub>'),
        (r"\name{static_load}", "<mi>static_load</mi>"),
        (r"\sin θ", '<mi>sin</mi><mspace width="0.17em"></mspace><mi>θ</mi>'),
        ("|v| < 1", f"{BAR}<mi>v</mi>{BAR}<mo>&lt;</mo><mn>1</mn>"),
        (r"\max_i y", '<msub><mi>max</mi><mi>i</mi></msub><mspace width="0.17em"></mspace><mi>y</mi>'),
    ],
)
def test_what_is_written(tex: str, content: str) -> None:
    assert mathml(tex) == f"<math>{content}</math>"
    assert mathml(tex, block=True) == f'<math display="block">{content}</math>'


@pytest.mark.parametrize("tex", ["{a", "a}", r"\unknown", "a_", r"\frac{1}", r"\vec P", r"\name{x"])
def test_mistakes_are_seen(tex: str) -> None:
    with pytest.raises(ValueError, match=r"brace|unknown command|too early"):
        mathml(tex)


@pytest.mark.parametrize("kind", KINDS)
def test_every_formula_of_every_scene_is_well_formed(kind: str) -> None:
    cable = small_scene(kind).cable
    for topic in equations_of(cable, variables_of(cable)):
        for formula in topic.formulas:
            for part in formula.split(r"\quad"):
                root = etree.fromstring(mathml(part))
                assert {len(e) - CHILDREN[e.tag] for e in root.iter() if e.tag in CHILDREN} <= {0}
            assert [formula.count(sign) for sign in "(["] == [formula.count(sign) for sign in ")]"]
