"""A network of capacities and conductances, and the exact elimination of its massless nodes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.plugin import FloatArray


@dataclass(frozen=True)
class System:
    """C dT/dt = -G T + B u + f q,  y = H T + D u; nodes of zero capacity are in balance at every moment."""

    nodes: Sequence[str]
    capacity_J_K: FloatArray  # C (n,)
    conductance_W_K: FloatArray  # G (n, n)
    input_matrix: FloatArray  # B (n, m)
    heat_share: FloatArray  # f (n,)
    output_matrix: FloatArray  # H (p, n)
    feedthrough: FloatArray  # D (p, m)


class Network:
    """Nodes joined by conductances; an input is a temperature behind a conductance, or a heat."""

    def __init__(self, inputs: Sequence[str]) -> None:
        self.inputs = tuple(inputs)
        self.nodes: list[str] = []
        self.capacity_J_K: list[float] = []
        self.joints: list[tuple[int, int, float]] = []
        self.holds: list[tuple[int, str, float]] = []
        self.heats: list[tuple[int, str, float]] = []

    def node(self, name: str, capacity_J_K: float = 0.0) -> int:
        """Add a node and return its index."""
        self.nodes.append(name)
        self.capacity_J_K.append(capacity_J_K)
        return len(self.nodes) - 1

    def load(self, node: int, capacity_J_K: float) -> None:
        """Add to the capacity of a node."""
        self.capacity_J_K[node] += capacity_J_K

    def join(self, a: int, b: int, conductance_W_K: float) -> None:
        """Join two nodes."""
        self.joints.append((a, b, conductance_W_K))

    def hold(self, node: int, temperature: str, conductance_W_K: float) -> None:
        """Join a node to an input temperature."""
        self.holds.append((node, temperature, conductance_W_K))

    def heat(self, node: int, source: str, per_unit_W: float) -> None:
        """Give a node heat in proportion to an input."""
        self.heats.append((node, source, per_unit_W))

    def row(self, weights: dict[int, float]) -> FloatArray:
        """Return the output that sums node temperatures by weight."""
        row = np.zeros(len(self.nodes))
        for node, weight in weights.items():
            row[node] += weight
        return row

    def system(self, heated: int, outputs: Sequence[FloatArray]) -> System:
        """Return the matrices of all nodes; the floor's heat goes to node `heated`."""
        count = len(self.nodes)
        conductance = np.zeros((count, count))
        inputs = np.zeros((count, len(self.inputs)))
        for a, b, value in self.joints:
            conductance[a, a] += value
            conductance[b, b] += value
            conductance[a, b] -= value
            conductance[b, a] -= value
        for node, name, value in self.holds:
            conductance[node, node] += value
            inputs[node, self.inputs.index(name)] += value
        for node, name, value in self.heats:
            inputs[node, self.inputs.index(name)] += value
        return System(
            tuple(self.nodes),
            np.array(self.capacity_J_K),
            conductance,
            inputs,
            self.row({heated: 1.0}),
            np.array(outputs),
            np.zeros((len(outputs), len(self.inputs))),
        )


def without_massless(system: System) -> System:
    """Eliminate the nodes of zero capacity exactly (Kron reduction), in state, inputs and outputs alike.

    With e the massless and k the other nodes: T_e = G_ee^-1 (B_e u - G_ek T_k).
    """
    massless = system.capacity_J_K == 0
    kept = ~massless
    of_kept = system.conductance_W_K[np.ix_(massless, kept)]
    solved = np.linalg.solve(
        system.conductance_W_K[np.ix_(massless, massless)],
        np.hstack([-of_kept, system.input_matrix[massless], system.heat_share[massless, None]]),
    )
    from_kept, from_input, from_heat = np.split(solved, [kept.sum(), solved.shape[1] - 1], axis=1)
    conductance = system.conductance_W_K[np.ix_(kept, kept)] + of_kept.T @ from_kept
    outputs = system.output_matrix[:, massless]
    return System(
        tuple(name for name, keep in zip(system.nodes, kept, strict=True) if keep),
        system.capacity_J_K[kept],
        (conductance + conductance.T) / 2,
        system.input_matrix[kept] - of_kept.T @ from_input,
        system.heat_share[kept] - of_kept.T @ from_heat[:, 0],
        system.output_matrix[:, kept] + outputs @ from_kept,
        system.feedthrough + outputs @ from_input,
    )
