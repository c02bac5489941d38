"""Compiled code and results belong to the source that they were made from: nothing of another block is taken for it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.conformance.broken.plugin import install, valve
from tests.conformance.broken.test_runs import STUDY
from tests.conftest import call
from waxstudy.conformance.drive import CompiledBlock
from waxstudy.plugin import Block, Valve


def of_gain(gain: float) -> type[Block]:
    """A valve as a catalogue of products makes them: one function, many classes."""

    class Made(Valve):
        name = "made"

        @staticmethod
        def step(p, x, u, t, dt):  # type: ignore[no-untyped-def]
            return gain * u

    return Made


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WAXSTUDY_CACHE", str(tmp_path / "cache"))


@pytest.mark.usefixtures("own_cache")
def test_blocks_that_one_function_makes_keep_their_own_figures() -> None:
    half, full = of_gain(0.5), of_gain(1.0)
    assert CompiledBlock(half, (), 5.0).run([0.8], 5.0) == [0.4]
    assert CompiledBlock(full, (), 5.0).run([0.8], 5.0) == [0.8]


IMPORTED = {
    "helper": ("from law import law", "return law(u)", "def law(u):\n    return {gain} * u\n"),
    "constant": ("from law import LAW", "return LAW * u", "LAW = {gain}\n"),
    "module": ("import law", "return law.LAW * u", "LAW = {gain}\n"),
    "value read from a file": ("from law import LAW", "return LAW * u", "LAW = float('{gain}')\n"),
}


def of_another(folder: Path, imports: str, step: str) -> None:
    """Write a study of a valve that takes its law from another module, and install the valve."""
    install(folder / "strangers", "law-of-another", valve(step, before=imports))
    (folder / "small.toml").write_text(STUDY.replace("VALVE", "law-of-another"))


def figures(folder: Path, law: str, *options: str) -> list[str]:
    """What is printed of that study under a law."""
    (folder / "strangers" / "law.py").write_text(law)
    done = call(folder, "run", "small.toml", *options, env={"PYTHONPATH": str(folder / "strangers")})
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.splitlines()[:-1]


@pytest.fixture(scope="module")
def interpreted(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The figures of a law of 0.875 that nothing was compiled for."""
    folder = tmp_path_factory.mktemp("python")
    imports, step, law = IMPORTED["helper"]
    of_another(folder, imports, step)
    return figures(folder, law.format(gain="0.875"), "--no-jit")


@pytest.mark.slow
@pytest.mark.parametrize(("imports", "step", "law"), IMPORTED.values(), ids=IMPORTED)
def test_what_a_step_takes_from_another_module_is_looked_at_again(
    tmp_path: Path, interpreted: list[str], imports: str, step: str, law: str
) -> None:
    of_another(tmp_path, imports, step)
    first, again = (figures(tmp_path, law.format(gain=gain)) for gain in ("0.5", "0.875"))
    assert again == interpreted
    assert again != first
