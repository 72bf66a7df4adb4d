"""Forces that are ours at the present values of their global parameters only: named, and frozen."""

from __future__ import annotations

from functools import cache
from itertools import chain, combinations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from click.testing import CliRunner
from openmmhelfrich.cli import main
from openmmhelfrich.vcm import strings
from openmmhelfrich.vcm.accelerate import Report, accelerate
from openmmhelfrich.vcm.recognise.fixed import Fixed
from test_vcm_accelerate import OURS, context_of, membrane, places, state_of, system_of

MEAN_AREA = 2000.0
HEIGHTS = "; ".join(
    f"h{a}=distance(p{a},p{b})*sin(angle(p{a},p{b},p{c}))"
    for a, b, c in ((1, 2, 3), (2, 3, 1), (3, 1, 2))
)
AREA = "; q=0.5*distance(p1,p2)*distance(p1,p3)*sin(angle(p2,p1,p3))"
ROOT = 2**0.25


def with_globals(force, text: str, values: dict[str, float]):
    """The same bonds with another expression, and these global parameters."""
    if isinstance(force, mm.CustomCVForce):
        result = mm.CustomCVForce(text)
        result.addCollectiveVariable(
            "total", mm.XmlSerializer.clone(force.getCollectiveVariable(0))
        )
    else:
        result = mm.CustomCompoundBondForce(force.getNumParticlesPerBond(), text)
        for number in range(force.getNumBonds()):
            result.addBond(force.getBondParameters(number)[0], [])
    for name, value in values.items():
        result.addGlobalParameter(name, value)
    return result


def triangle_force(text: str, values: dict[str, float]) -> list[mm.Force]:
    force = mm.CustomCompoundBondForce(3, text)
    for triangle in membrane().triangles.tolist():
        force.addBond(triangle, [])
    return [with_globals(force, text, values)]


def heights(text: str, **values: float) -> list[mm.Force]:
    """A function of h at each height."""
    return triangle_force(
        "+".join(f"({text.format(h=f'h{i}')})" for i in (1, 2, 3)) + f"; {HEIGHTS}", values
    )


def rewritten(
    name: str, old: str, new: str, style: str = "sums", **values: float
) -> list[mm.Force]:
    """Our own strings with another energy, of which these are global parameters."""
    result = []
    for force in strings.custom_forces(OURS[name], style):
        text = force.getEnergyFunction()
        assert old in text
        parts = text.replace(old, new, 1).split("; ")
        kept = [part for part in parts if part.partition("=")[0] not in values]
        result.append(with_globals(force, "; ".join(kept), values))
    return result


def pairs_with_two_targets() -> list[mm.Force]:
    single, pairs = strings.custom_forces(OURS["volume"], "pairs")
    values = {"k": 0.04, "target": OURS["volume"].getTarget(), "other": OURS["volume"].getTarget()}
    result = []
    for force, old in ((single, ")/target"), (pairs, "*r/target")):
        text = force.getEnergyFunction()
        assert old in text
        kept = [p for p in text.replace(old, old.replace("target", "other")).split("; ")]
        kept = [p for p in kept if p.partition("=")[0] not in values]
        result.append(with_globals(force, "; ".join(kept), values))
    return result


def weighted_sum() -> list[mm.Force]:
    """A collective variable with a global parameter."""
    (force,) = strings.custom_forces(OURS["area"])
    inner = force.getCollectiveVariable(0)
    result = mm.CustomCVForce(force.getEnergyFunction())
    weighted = with_globals(inner, f"w*{inner.getEnergyFunction()}", {"w": 1.0})
    result.addCollectiveVariable("total", weighted)
    return [result]


REPULSION = "eps*((s/{h})^8-(s/{h})^4+0.25)*step(hc-{h})"
#: name: (forces, class, what is needed, in words, scalars that stay parameters of the Context,
#: whether another value of what is frozen would be another energy).
CASES = {
    "cutoff of heights": (
        lambda: heights(REPULSION, eps=10, s=60, hc=ROOT * 60),
        "TriangleHeightForce", ("hc",), "hc = 2^¼ s",
        {"minHeight": "s", "epsilon": "eps"}, True,
    ),
    "cutoff of heights of a number": (
        lambda: heights(REPULSION.replace("s/", "60/"), eps=10, hc=ROOT * 60),
        "TriangleHeightForce", ("hc",), "hc = 71.3524269 (2^¼ minHeight)",
        {"epsilon": "eps"}, True,
    ),
    "cutoff of squared heights": (
        lambda: heights(
            "eps*((s/{h})^8-(s/{h})^4+0.25)*step(hc2-{h}^2)", eps=10, s=60, hc2=np.sqrt(2) * 3600
        ),
        "TriangleHeightForce", ("hc2",), "hc2 = 2^½ s^2",
        {"minHeight": "s", "epsilon": "eps"}, True,
    ),
    "two strengths and a cutoff": (
        lambda: heights(
            "(e8*(s/{h})^8-e4*(s/{h})^4+0.25*e8)*step(hc-{h})", e8=10, e4=10, s=60, hc=ROOT * 60
        ),
        "TriangleHeightForce", ("e4", "hc"), "e4 = e8 and hc = 2^¼ s",
        {"minHeight": "s", "epsilon": "e8"}, True,
    ),
    "cutoff of areas": (
        lambda: triangle_force(
            "eps*((m/q)^8-(m/q)^4+0.25)*step(ac-q)" + AREA,
            {"eps": 10, "m": MEAN_AREA, "ac": ROOT * MEAN_AREA},
        ),
        "TriangleAreaRepulsionForce", ("ac",), "ac = 2^¼ m",
        {"minArea": "m", "epsilon": "eps"}, True,
    ),
    "areas with two targets": (
        lambda: triangle_force(
            "0.5*k*(q-a0)^2/a1" + AREA, {"k": 2.5, "a0": MEAN_AREA, "a1": MEAN_AREA}
        ),
        "TriangleAreaForce", ("a1",), "a1 = a0", {"modulus": "k", "target": "a0"}, False,
    ),
    "dihedrals with a prefactor": (
        lambda: rewritten("Quartic", "K*u^2", "K*boost^2*u^2", K=40, boost=1.0),
        "DihedralForce", ("boost",), "boost = 1", {"stiffness": "K"}, False,
    ),
    "dihedrals with a switch": (
        lambda: rewritten("Cosine", "K*u", "select(mode,K*u,K*u^3)", K=40, mode=1.0),
        "DihedralForce", ("mode",), "mode = 1", {"stiffness": "K"}, False,
    ),
    "dihedrals with a term switched off": (
        lambda: rewritten("Exp", "0.5*K", "tilt*distance(p1,p4)+0.5*K", K=40, tilt=0.0),
        "DihedralForce", ("tilt",), "tilt = 0", {"stiffness": "K"}, True,
    ),
    "bending with a square of C0": (
        lambda: rewritten(
            "Espriu unsigned", "C0^2*a", "C0sq*a", k=50, C0=0.013, C0sq=0.013**2
        ),
        "BendingForce", ("C0sq",), "C0sq = C0^2",
        {"rigidity": "k", "spontaneousCurvature": "C0"}, True,
    ),
    "bending with two rigidities": (
        lambda: rewritten(
            "Julicher curved", "0.5*k*(J^2/a-2*C0*J+C0^2*a)",
            "0.5*(k*J^2/a-2*kc*C0*J+kc*C0^2*a)", k=50, C0=-0.013, kc=50,
        ),
        "BendingForce", ("kc",), "kc = k",
        {"rigidity": "k", "spontaneousCurvature": "C0"}, True,
    ),
    "total area with two targets": (
        lambda: rewritten(
            "area", ")^2/target", ")^2/other", k=1.3,
            target=OURS["area"].getTarget(), other=OURS["area"].getTarget(),
        ),
        "SurfaceAreaForce", ("other",), "other = target",
        {"modulus": "k", "target": "target"}, False,
    ),
    "total volume in pairs": (
        pairs_with_two_targets,
        "EnclosedVolumeForce", ("other",), "other = target",
        {"modulus": "k", "target": "target"}, False,
    ),
    "a weighted sum": (
        weighted_sum, "SurfaceAreaForce", ("w",), "w = 1", {}, False,
    ),
}  # fmt: skip


@cache
def given(name: str) -> mm.System:
    return system_of(CASES[name][0]())


def parameters(system: mm.System) -> dict[str, float]:
    return dict(context_of(system).getParameters())


def followed(report: Report) -> dict[str, Fixed]:
    return {f.name: f for replaced in report.replaced for f in replaced.fixed}


@cache
def given_context(name: str) -> mm.Context:
    """OpenMM takes seconds to compile a bending energy."""
    return context_of(given(name))


def assert_equal(
    given: mm.Context, faster: mm.System, report: Report, scale: float = 0.0, tolerance=1e-12
) -> None:
    """Where the parameters are, and where those that are left have gone; frozen ones follow.

    scale: of what the strings add up, kJ/mol, where most of it cancels.
    """
    ours = context_of(faster)
    free = dict(ours.getParameters())
    rng = np.random.default_rng(3)
    for change in (0.0, 0.4):
        values = {name: value * (1 + change * rng.uniform(-1, 1)) for name, value in free.items()}
        for name, fixed in followed(report).items():
            values[name] = (
                fixed.factor * values[fixed.base] ** fixed.power if fixed.base else fixed.value
            )
        for context in (given, ours):
            for name in context.getParameters():
                context.setParameter(name, values[name])
        for positions in places():
            (energy, forces), (our_energy, our_forces) = (
                state_of(context, positions) for context in (given, ours)
            )
            assert abs(our_energy - energy) <= tolerance * max(abs(energy), scale)
            size = np.abs(forces).max()
            assert size > 0
            np.testing.assert_allclose(our_forces, forces, rtol=0, atol=tolerance * size)


def scale_of(name: str) -> float:
    """½ k V0 is what a sum over pairs has to cancel."""
    ours = OURS["volume"]
    return 0.5 * ours.getModulus() * ours.getTarget() if name == "total volume in pairs" else 0.0


@pytest.mark.parametrize("name", CASES)
def test_named_and_left_alone(name):
    """Without being asked nothing is replaced, but the report says what it is and what to do."""
    _, cls, needed, words, _, _ = CASES[name]
    system = given(name)
    before = [mm.XmlSerializer.serialize(force) for force in system.getForces()]
    same, report = accelerate(system)
    assert report.replaced == []
    assert [mm.XmlSerializer.serialize(force) for force in same.getForces()] == before
    for left in report.left:
        assert f"it is {cls} where {words};" in left.reason
        assert f"to replace it, freeze {', '.join(needed)}" in left.reason
        assert left.freeze == needed


@pytest.mark.parametrize("name", CASES)
def test_frozen_and_replaced(name):
    """Energies and forces are the same to 1e-12, also where other parameters change."""
    _, cls, needed, words, scalars, _ = CASES[name]
    system = given(name)
    faster, report = accelerate(system, membrane().positions, freeze=needed)
    assert [r.force_class for r in report.replaced] == [cls], str(report)
    assert report.left == []
    (force,) = faster.getForces()
    ours = getattr(helfrich, cls).cast(force)
    for number in range(ours.getNumParameters()):
        key = ours.getParameterName(number)
        assert ours.getContextParameter(key) == scalars.get(key, "")
    assert set(parameters(faster)) == set(scalars.values())
    assert {f.name for f in report.replaced[0].fixed} == set(needed)
    text = str(report)
    for part in words.partition(" (")[0].split(" and "):
        assert f"fixed: {part}" in text
    for frozen in needed:
        assert f"{frozen} is no longer a parameter of the Context" in text
    assert_equal(given_context(name), faster, report, scale_of(name))


@pytest.mark.long
@pytest.mark.parametrize("name", CASES)
def test_all_subsets_of_what_can_be_frozen(name):
    """Whatever is frozen, what is replaced is the same energy; the needed ones are enough."""
    system = given(name)
    names = sorted(parameters(system))
    needed = set(CASES[name][2])
    every = chain.from_iterable(combinations(names, n) for n in range(len(names) + 1))
    for frozen in every:
        faster, report = accelerate(system, freeze=frozen)
        if needed <= set(frozen):
            assert report.left == [], (frozen, str(report))
        if report.replaced:
            assert set(parameters(faster)) == set(names) - set(frozen)
            assert set(followed(report)) == set(frozen)
            assert_equal(given_context(name), faster, report, scale_of(name))


@pytest.mark.parametrize("change", [1e-5, -0.01])
@pytest.mark.parametrize("name", [name for name, case in CASES.items() if case[-1]])
def test_elsewhere_it_is_another_energy(name, change):
    """A little beside the value that makes it ours, freezing all does not help, nor is it said."""
    forces = CASES[name][0]()
    for which in CASES[name][2]:
        system = system_of([mm.XmlSerializer.clone(force) for force in forces])
        for force in system.getForces():
            for number in range(force.getNumGlobalParameters()):
                if force.getGlobalParameterName(number) == which:
                    value = force.getGlobalParameterDefaultValue(number)
                    moved = value * (1 + change) if value else change
                    force.setGlobalParameterDefaultValue(number, moved)
        for frozen in ((), parameters(system)):
            _, report = accelerate(system, freeze=frozen)
            assert report.replaced == [], str(report)
            assert all("freeze" not in left.reason and not left.freeze for left in report.left)


@pytest.mark.parametrize("seed", range(20))
def test_random_repulsions(seed):
    """One of the relations between four prefactors and a cutoff is broken, or none."""
    rng = np.random.default_rng(seed)
    s, eps = rng.uniform(50, 70), rng.uniform(5, 20)
    values = {"e8": eps, "e4": eps, "e0": eps / 4, "s8": s**8, "s4": s**4, "hc": ROOT * s}
    broken = str(rng.choice(["", *values]))
    if broken:
        values[broken] *= 1 + rng.choice([-1, 1]) * 10 ** rng.uniform(-4.5, -0.5)
    system = system_of(heights("(e8*s8/{h}^8-e4*s4/{h}^4+e0)*step(hc-{h})", **values))
    faster, report = accelerate(system, freeze=values)
    if broken:
        assert report.replaced == []
    else:
        assert report.left == []
        assert_equal(context_of(system), faster, report)


#: What a slip of the hand could change in an expression, or nothing at all.
SLIPS = [
    ("^8", "^6"), ("^8", "^8.001"), ("^4", "^2"), ("0.25", "0.5"), ("0.25", "0.2500001"),
    ("-", "+"), ("step(", "("), ("step(", "0.999*step("), ("sin(", "cos("), ("p3", "p2"),
    ("0.5", "0.25"), ("eps", "2*eps"), ("eps", "eps^2"), ("eps*", "(eps+s^4/60^4-1)*"),
    ("eps*", "select(step(s-50),eps,1)*"), ("eps*", "select(step(s-50),eps,eps)*"),
    ("eps*", "max(eps,9)*"), ("eps*", "abs(eps)*"), ("s/", "hc/"), ("s/", "max(s,1)/"),
    ("s/", "(hc/1.189207115002721)/"), ("hc-", "s-"), ("hc-", "1.0001*hc-"),
    ("hc-", "hc*step(s-10)-"), ("hc-", "min(hc,1e5)-"), ("hc-", "hc^2/hc-"), ("^2/", "^4/"),
    ("a1", "(a1+k)"), ("a0", "(2*a0-a1)"), ("k*", "(k+a0-a1)*"), ("k*", "k*k/k*"),
    ("k*", "abs(k)*"),
]  # fmt: skip


@pytest.mark.parametrize(
    "slip",
    [
        pytest.param(slip, id=" ".join(slip), marks=[pytest.mark.long] if number % 3 else [])
        for number, slip in enumerate(SLIPS)
    ],
)
def test_slips_are_no_wrong_conversion(slip):
    """An expression with a slip is left alone, or the forces that replace it have its energy."""
    old, new = slip
    tried = 0
    for name in ("cutoff of heights", "areas with two targets"):
        (force,) = CASES[name][0]()
        text = force.getEnergyFunction()
        values = {
            force.getGlobalParameterName(i): force.getGlobalParameterDefaultValue(i)
            for i in range(force.getNumGlobalParameters())
        }
        starts = [i for i in range(len(text)) if text.startswith(old, i)]
        # The first, the last, and all of them.
        variants = {text[:i] + new + text[i + len(old) :] for i in (*starts[:1], *starts[-1:])}
        for changed in sorted(variants | ({text.replace(old, new)} if starts else set())):
            tried += 1
            system = system_of([with_globals(force, changed, values)])
            for frozen in (CASES[name][2], tuple(values)):
                faster, report = accelerate(system, freeze=frozen)
                if report.replaced:
                    assert_equal(context_of(system), faster, report, tolerance=1e-11)
    assert tried


@pytest.mark.parametrize(
    ("strength", "needed"),
    [
        ("max(eps,1)", ("eps", "hc")),
        ("abs(eps)", ("eps", "hc")),
        ("select(step(s-50),eps,1)", ("s", "hc")),
    ],
)
def test_branches_of_parameters(strength, needed):
    """Values that no trial has had are not to be trusted, unless they are frozen."""
    system = system_of(heights(REPULSION.replace("eps", strength), eps=10, s=60, hc=ROOT * 60))
    _, report = accelerate(system, freeze=["hc"])
    assert report.replaced == []
    assert set(report.left[0].freeze) == set(needed)
    faster, report = accelerate(system, freeze=needed)
    assert report.left == []
    assert_equal(context_of(system), faster, report)


# --- what becomes of the parameters --------------------------------------------------------------


def test_a_cutoff_that_follows_or_does_not():
    """hc alone becomes a multiple of s; with s it is a number, and nothing is left to follow."""
    system = given("cutoff of heights")
    faster, report = accelerate(system, freeze=["hc"])
    assert "fixed: hc = 2^¼ s, now 71.3524269; it follows s, which it did not by itself" in str(
        report
    )
    context = context_of(faster)
    context.setParameter("s", 45.0)
    with pytest.raises(mm.OpenMMException, match="hc"):
        context.setParameter("hc", 80.0)
    old = context_of(system)
    old.setParameter("s", 45.0)
    positions = membrane().positions
    new_energy, old_energy = state_of(context, positions)[0], state_of(old, positions)[0]
    # The given System would have cut off where hc still is.
    assert abs(new_energy - old_energy) > 0.01 * old_energy
    faster, report = accelerate(system, freeze=["hc", "s"])
    assert set(parameters(faster)) == {"eps"}
    assert "follows" not in str(report)


def test_other_forces_keep_a_frozen_parameter():
    """It stays a parameter of the Context for them, and the report says for which."""
    spring = mm.CustomBondForce("hc*r")
    spring.addGlobalParameter("hc", ROOT * 60)
    spring.addBond(1, 2, [])
    spring.setName("springs")
    system = system_of([*CASES["cutoff of heights"][0](), spring])
    faster, report = accelerate(system, freeze=["hc"])
    assert [left.index for left in report.left] == [1]
    assert "hc is still a parameter of the Context" in report.notes[0]
    assert "1 (springs)" in report.notes[0]
    assert set(parameters(faster)) == {"eps", "s", "hc"}
    assert_equal(context_of(system), faster, report)


def test_a_parameter_that_is_ours_as_well():
    """A number in every force that is replaced: it does not go on in one and stop in another."""
    forces = CASES["cutoff of heights of a number"][0]()
    forces += rewritten("Quartic", "K*u^2", "eps*u^2", eps=10.0, K=0.0)
    for force in forces[1:]:
        assert "eps" in force.getEnergyFunction()
    system = system_of(forces)
    faster, report = accelerate(system, freeze=["hc", "eps", "K"])
    assert report.left == []
    assert parameters(faster) == {}
    assert "fixed: eps = 10" in str(report)


def test_an_unused_parameter_may_go():
    (force,) = strings.custom_forces(OURS["Quartic"])
    force.addGlobalParameter("unused", 1.5)
    system = system_of([force])
    _, report = accelerate(system)
    reason = report.left[0].reason
    assert "would lose the parameter unused" in reason
    assert "it is DihedralForce where unused = 1.5;" in reason
    faster, report = accelerate(system, freeze=report.left[0].freeze)
    assert report.left == []
    assert_equal(context_of(system), faster, report)


@pytest.mark.parametrize(
    ("by", "reason"),
    [
        ("hc", "the derivative by hc would be lost"),
        ("s", "the derivative by s would be another one"),
    ],
)
def test_derivatives_are_not_lost(by, reason):
    forces = CASES["cutoff of heights"][0]()
    forces[0].addEnergyParameterDerivative(by)
    system = system_of(forces)
    for frozen in ([], ["hc"]):
        _, report = accelerate(system, freeze=frozen)
        assert report.replaced == []
        assert reason in report.left[0].reason
        assert report.left[0].freeze == ()


def test_frozen_in_vain():
    system = system_of(strings.custom_forces(OURS["Quartic"]) + CASES["cutoff of heights"][0]())
    _, report = accelerate(system, freeze="s")
    assert "s is frozen in no force: none that was replaced has it" in str(report)
    # With s a number the cutoff is one too.
    assert report.left[0].freeze == ("s", "hc")


def test_unknown_names():
    with pytest.raises(ValueError, match=r"freeze: no force .* 'cutoff'; there are: eps, s, hc$"):
        accelerate(given("cutoff of heights"), freeze=["cutoff"])
    with pytest.raises(ValueError, match=r"global parameter 's'; there are: none"):
        accelerate(system_of(strings.custom_forces(OURS["Quartic"])), freeze="s")
    two = heights(REPULSION, eps=10, s=60, hc=ROOT * 60) + heights(
        REPULSION, eps=10, s=60, hc=ROOT * 50
    )
    with pytest.raises(ValueError, match=r"different defaults of hc: 59.4603558, 71.3524269"):
        accelerate(system_of(two), freeze=["hc"])


def test_command_line(tmp_path):
    """What `convert` prints is what it must be told."""
    path, out = tmp_path / "system.xml", tmp_path / "new.xml"
    path.write_text(mm.XmlSerializer.serialize(given("cutoff of heights")), encoding="utf-8")
    result = CliRunner().invoke(main, ["convert", str(path), "-o", str(out)])
    assert result.exit_code == 1
    assert "to replace it, freeze hc" in result.output
    assert not out.exists()
    result = CliRunner().invoke(
        main, ["convert", str(path), "-o", str(out), "--freeze", "hc", "--freeze", "s"]
    )
    assert result.exit_code == 0, result.output
    assert "fixed: s = 60" in result.output
    made = mm.XmlSerializer.deserialize(out.read_text(encoding="utf-8"))
    assert set(parameters(made)) == {"eps"}
    result = CliRunner().invoke(main, ["convert", str(path), "--freeze", "cutoff"])
    assert result.exit_code == 1
    assert "no force of the System has a global parameter 'cutoff'" in result.output
