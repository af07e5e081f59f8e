"""The certified truth about a picture's very rays: where each enters the solid first, and how that is known.

Two proofs that share nothing but the rays: interval arithmetic on the field as it is after all passes (`certify`), and,
where every leaf has ray intervals in closed form, merged float64 events of the scene as it was written (`closed`).
Where a ray has both they must agree, or there is a bug in sdfc, and it is said so.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from sdfc import pipeline
from sdfc.diagnostics import InternalError
from sdfc.field.derivative import gradient
from sdfc.field.graph import Expr
from sdfc.field.numeric import Evaluator
from sdfc.field.order import evaluation_order
from sdfc.measure import store
from sdfc.measure.identity import digest
from sdfc.measure.judge import FAR, THIN, near_enough, tolerance
from sdfc.measure.picture import Picture
from sdfc.pipeline import Compiled
from sdfc.reference.certify import Certificate, Status, first_roots
from sdfc.reference.closed import closed_roots, is_closed_form, joined
from sdfc.shape.lower import lower

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]
Params: TypeAlias = Mapping[str, tuple[float, ...]]
Progress: TypeAlias = Callable[[float], None]

BATCH = 16384  # rays proved at once: many take hardly more calls of NumPy than few
AFFORDABLE = 200_000_000  # nodes of the field times rays: beyond it intervals check a sample of what events answer
LEAST_SAMPLE = 64
AGREE = 1e-9  # of the largest coordinate: how far apart the two proofs may place an uncontested entry
CREASE = np.radians(1.0)
BEFORE = 1e-9  # normals are read this far before the hit: on the surface itself a distance may have a kink


class Proof(IntEnum):
    """How a ray's answer is known."""

    EVENTS = 1  # float64 closed forms
    INTERVALS = 2
    BOTH = 3  # and they agree


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """What is known of n rays, in the scene's own coordinates.

    certificate  Where each enters the solid first; whether that is contested (see `first_roots` and `closed_roots`).
    proof        Proof per ray.
    normal       (3, n) the field's unit gradient at the hit; NaN without a hit.
    crease       Hits where the gradient turns by more than a degree within what a tracer may be off, or has no value.
    tolerance    Rays are contested where an error of this size in the field may decide.
    """

    certificate: Certificate
    proof: NDArray[np.int8]
    normal: Array
    crease: Mask
    tolerance: float
    from_cache: bool = False

    @property
    def hit(self) -> Mask:
        """Proved hits, contested ones included."""
        return cast(Mask, self.certificate.status == Status.HIT)

    @property
    def t(self) -> Array:
        """Where each ray enters, half way through its bracket; inf where nothing is hit or known."""
        lo, hi = self.certificate.t_lo, self.certificate.t_hi
        return np.where(self.hit, lo + 0.5 * (np.where(self.hit, hi, 0.0) - np.where(self.hit, lo, 0.0)), np.inf)

    @property
    def sure(self) -> Mask:
        """Rays on which a tracer has no excuse."""
        return cast(Mask, ~self.certificate.contested & (self.certificate.status != Status.AMBIGUOUS))


def truth_of(
    compiled: Compiled,
    picture: Picture,
    cone: tuple[float, float],
    *,
    params: Params | None = None,
    progress: Progress | None = None,
    cache: bool = True,
) -> Truth:
    """The truth about the picture's rays (`picture.o`, `picture.d`; what the tracer answered is not looked at).

    `cone`: half a pixel at the eye and its growth with t, which the tolerance is made of (see `tolerance`). `params`:
    live values where they are not the defaults. Raises InternalError, naming a ray, where the two proofs disagree.
    """
    question = _Question.of(compiled, picture, tolerance(compiled, picture, cone), params or {})
    key = question.key
    kept = store.load("truth", key) if cache else None
    found = None if kept is None else _unpacked(kept, picture.o.shape[1])
    if found is None:
        found = question.answer(near_enough(compiled, picture, cone), progress or _silent)
        if cache:
            store.save("truth", key, _packed(found))
    if progress is not None:
        progress(1.0)
    return found


def _silent(share: float) -> None:
    """Nobody asked."""


@dataclass(frozen=True, slots=True, eq=False)
class _Question:
    """Everything that an answer depends on."""

    compiled: Compiled
    distance: Expr
    params: dict[str, tuple[float, ...]]
    o: Array
    d: Array
    end: Array
    tolerance: float

    @classmethod
    def of(cls, compiled: Compiled, picture: Picture, near: float, params: Params) -> _Question:
        values = {p.name: p.default for p in compiled.scene.params} | dict(params)
        with pipeline.deep_recursion():
            distance = lower(compiled.shape, compiled.scene.values.input("p"))
        reach = np.linalg.norm(picture.o, axis=0) + 1.01
        end = reach if compiled.frame.is_finite else np.full(reach.shape, FAR)
        return cls(compiled, distance, values, picture.o, picture.d, end, near)

    @property
    def key(self) -> str:
        """A hash of all of it, and of the code that answers."""
        frame = self.compiled.frame
        numbers = (self.tolerance, THIN, AFFORDABLE, frame.radius, *frame.centre, sorted(self.params.items()))
        return digest(self.compiled, self.distance, numbers, (self.o, self.d, self.end))

    def answer(self, near: float, progress: Progress) -> Truth:
        """Proved anew."""
        count = self.o.shape[1]
        proof = np.zeros(count, np.int8)
        certificate: Certificate | None = None
        index = np.arange(count)
        if is_closed_form(self.compiled.scene.root):
            certificate = self._by_events()
            proof |= Proof.EVENTS
            index = self._sample()
        proved = self._by_intervals(index, progress)
        proof[index] |= Proof.INTERVALS
        if certificate is not None:
            self._check(certificate, proved, index)
            for name in Certificate.__slots__:
                getattr(certificate, name)[index] = getattr(proved, name)
        known = certificate or proved
        normal, crease = self._normals(known, near)
        return Truth(known, proof, normal, crease, self.tolerance)

    def _sample(self) -> NDArray[np.intp]:
        """The rays for which intervals are affordable: all, or a random choice (always the same for the same rays)."""
        count = self.o.shape[1]
        most = max(LEAST_SAMPLE, AFFORDABLE // len(evaluation_order([self.distance])))
        if most >= count:
            return np.arange(count)
        return np.sort(np.random.default_rng(count).choice(count, most, replace=False))

    def _by_events(self) -> Certificate:
        scene, frame = self.compiled.scene, self.compiled.frame
        origin = self.o * frame.radius + np.array(frame.centre)[:, None]
        with pipeline.deep_recursion():
            return closed_roots(
                scene.root,
                scene.values,
                origin,
                self.d * frame.radius,
                0.0,
                self.end,
                self.params,
                thin=THIN,
                tolerance=self.tolerance * frame.radius,
            )

    def _by_intervals(self, index: NDArray[np.intp], progress: Progress) -> Certificate:
        parts = []
        for first in range(0, max(index.size, 1), BATCH):
            some = index[first : first + BATCH]

            def tell(share: float, before: int = first, size: int = some.size) -> None:
                progress((before + share * size) / max(index.size, 1))

            parts.append(
                first_roots(
                    self.distance,
                    self.o[:, some],
                    self.d[:, some],
                    0.0,
                    self.end[some],
                    self.params,
                    thin=THIN,
                    tolerance=self.tolerance,
                    progress=tell,
                )
            )
        return joined(parts)

    def _check(self, events: Certificate, proved: Certificate, index: NDArray[np.intp]) -> None:
        """Raises where an uncontested ray has two answers."""
        status, contested = events.status[index], events.contested[index] | proved.contested
        sure = ~contested & (proved.status != Status.AMBIGUOUS)
        both = sure & (status == Status.HIT) & (proved.status == Status.HIT)
        frame = self.compiled.frame
        away = float(np.linalg.norm(frame.centre)) / frame.radius  # events are in the scene's written coordinates
        scale = 1.0 + away + np.abs(self.o[:, index]).max(axis=0, initial=0.0)
        after, before = (np.where(both, t, 0.0) for t in (events.t_lo[index] - AGREE * scale, proved.t_hi))
        until, since = (np.where(both, t, 0.0) for t in (events.t_hi[index] + AGREE * scale, proved.t_lo))
        apart = (after > before) | (since > until)
        wrong = np.flatnonzero((sure & (status != proved.status)) | apart)
        if wrong.size == 0:
            return
        first = int(wrong[0])
        ray = int(index[first])
        told = [f"{Status(c.status[i]).name} at {c.t_lo[i]:.17g}" for c, i in ((events, ray), (proved, first))]
        raise InternalError(
            f"the two proofs disagree about {wrong.size} of {index.size} rays, first about ray {ray}, from "
            f"{self.o[:, ray].tolist()} along {self.d[:, ray].tolist()}: closed forms say {told[0]}, "
            f"intervals say {told[1]}"
        )

    def _normals(self, known: Certificate, near: float) -> tuple[Array, Mask]:
        """Unit gradients at the hits, and where they are not to be compared."""
        count = self.o.shape[1]
        normal, crease = np.full((3, count), np.nan), np.zeros(count, bool)
        hits = np.flatnonzero(known.status == Status.HIT)
        if hits.size == 0:
            return normal, crease
        p = self.compiled.scene.values.input("p")
        with pipeline.deep_recursion():
            slope = Evaluator([gradient(self.distance, p)])
        points = self.o[:, hits] + (known.t_lo[hits] - BEFORE) * self.d[:, hits]

        def unit_gradient(at: Array) -> Array:
            (found,) = slope({"p": at}, self.params)
            with np.errstate(all="ignore"):
                return np.broadcast_to(found / np.linalg.norm(found, axis=0), at.shape)

        first = unit_gradient(points)
        turned = ~np.isfinite(first).all(axis=0)
        for side in _tangents(np.where(turned, 0.0, first)):
            for step in (near, -near):
                turned |= ~(_angle(first, unit_gradient(points + step * side)) <= CREASE)
        normal[:, hits], crease[hits] = first, turned
        return normal, crease


def _tangents(normal: Array) -> tuple[Array, Array]:
    """Two unit vectors at right angles to each of the normals (3, n) and to each other."""
    axis = np.eye(3)[np.argmin(np.abs(normal), axis=0)].T
    first = np.cross(normal, axis, axis=0)
    first /= np.maximum(np.linalg.norm(first, axis=0), 1e-300)
    return first, np.cross(normal, first, axis=0)


def _angle(a: Array, b: Array) -> Array:
    """Between unit vectors (3, n), in radians; right for tiny angles too."""
    angle: Array = 2.0 * np.arctan2(np.linalg.norm(a - b, axis=0), np.linalg.norm(a + b, axis=0))
    return angle


def _packed(truth: Truth) -> dict[str, NDArray[np.generic]]:
    arrays: dict[str, NDArray[np.generic]] = {name: getattr(truth.certificate, name) for name in Certificate.__slots__}
    return arrays | {
        "proof": truth.proof,
        "normal": truth.normal,
        "crease": truth.crease,
        "tolerance": np.array(truth.tolerance),
    }


def _unpacked(arrays: Mapping[str, NDArray[np.generic]], count: int) -> Truth | None:
    """What `_packed` made, or None where a file holds something else."""
    names = (*Certificate.__slots__, "proof", "crease")
    if {*names, "normal", "tolerance"} != set(arrays) or any(arrays[name].shape != (count,) for name in names):
        return None
    certificate = Certificate(*(arrays[name] for name in Certificate.__slots__))  # type: ignore[arg-type]
    proof, normal, crease = (arrays[name] for name in ("proof", "normal", "crease"))
    return Truth(certificate, proof, normal, crease, float(arrays["tolerance"]), from_cache=True)  # type: ignore[arg-type]
