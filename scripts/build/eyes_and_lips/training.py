# SPDX-License-Identifier: GPL-3.0-or-later
"""Convolutional regressors of points and of their spread, fitted with JAX."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import optax

# Convolutions, 3 x 3: channels and stride
LAYERS = ((16, 2), (32, 2), (32, 1), (64, 2), (64, 1), (96, 2), (96, 1))
NARROW, HIDDEN = 32, 128
BATCH, PEAK_RATE, DECAY = 128, 2e-3, 1e-4
LEAST_SPREAD, LOG_SPREADS = 0.003, (-7, 2)  # sides of the square, and what is added to them
LEAST_CONTRAST = 0.02


@dataclass(frozen=True)
class Part:
    """What one regressor sees: points, in groups that share a spread."""

    name: str
    groups: tuple[int, ...]  # of every point the number of its group

    @property
    def num_groups(self) -> int:
        return max(self.groups) + 1


EYE = Part("eye", (*[0] * 9, *[1] * 9, *[2] * 5))
MOUTH = Part("mouth", (*[0] * 11, *[1] * 11, *[2] * 11, *[3] * 11))
Weights = list[dict[str, jax.Array]]


def initial(part: Part, mean: np.ndarray, seed: int) -> Weights:
    """He's initialisation; the last layer gives the mean shape."""
    key = jax.random.PRNGKey(seed)
    weights, channels = [], 3

    def layer(shape: tuple[int, ...], fan_in: int, scale: float = 1.0) -> dict[str, jax.Array]:
        nonlocal key
        key, own = jax.random.split(key)
        drawn = scale * jnp.sqrt(2.0 / fan_in) * jax.random.normal(own, shape)
        return {"w": drawn, "b": jnp.zeros(shape[0])}

    for width, _ in LAYERS:
        weights.append(layer((width, channels, 3, 3), 9 * channels))
        channels = width
    weights.append(layer((NARROW, channels, 1, 1), channels))
    weights.append(layer((HIDDEN, NARROW * 16), NARROW * 16))
    outputs = 2 * len(part.groups) + part.num_groups
    last = layer((outputs, HIDDEN), HIDDEN, 0.1)
    last["b"] = jnp.concatenate([jnp.asarray(mean.ravel()), jnp.full(part.num_groups, -3.0)])
    return [*weights, last]


def outputs_of(weights: Weights, pictures: jax.Array) -> jax.Array:
    """pictures: B x 3 x 64 x 64, of mean 0 and deviation 1 each."""
    x = pictures
    strides = [*(stride for _, stride in LAYERS), 1]
    for layer, stride in zip(weights[: len(strides)], strides, strict=True):
        x = jax.lax.conv_general_dilated(
            x,
            layer["w"],
            (stride, stride),
            ((1, 1), (1, 1)) if layer["w"].shape[2] == 3 else ((0, 0), (0, 0)),
        )
        x = jax.nn.relu(x + layer["b"][:, None, None])
    x = x.reshape(len(x), -1)
    x = jax.nn.relu(x @ weights[-2]["w"].T + weights[-2]["b"])
    return x @ weights[-1]["w"].T + weights[-1]["b"]


def standardised(pictures: jax.Array) -> jax.Array:
    """B x H x W x 3 in 0 to 255 -> B x 3 x H x W of mean 0 and deviation 1 each."""
    x = pictures.astype(jnp.float32).transpose(0, 3, 1, 2) / 255
    mean = x.mean((1, 2, 3), keepdims=True)
    return (x - mean) / (x.std((1, 2, 3), keepdims=True) + LEAST_CONTRAST)


def loss_of(weights: Weights, pictures: jax.Array, points: jax.Array, part: Part) -> jax.Array:
    """Negative log likelihood of points whose errors are Laplace's, a spread a group."""
    seen = outputs_of(weights, standardised(pictures))
    count = 2 * len(part.groups)
    off = jnp.abs(seen[:, :count].reshape(-1, len(part.groups), 2) - points).sum(2)
    spread = (
        LEAST_SPREAD + jnp.exp(jnp.clip(seen[:, count:], *LOG_SPREADS))[:, np.array(part.groups)]
    )
    return (off / spread + 2 * jnp.log(spread)).mean()


def descent(
    loss: Callable[..., jax.Array], weights: Weights, steps: int, peak_rate: float, decay: float
) -> tuple[optax.OptState, Callable]:
    """A state of the optimiser, and a step: (weights, state, pictures, truth ..., tint) -> the same
    and the loss. loss: of weights, pictures and truth; tint: B x 6, gain and offset of colours."""
    rate = optax.cosine_onecycle_schedule(steps, peak_rate, 0.1)
    optimiser = optax.chain(optax.clip_by_global_norm(1.0), optax.adamw(rate, weight_decay=decay))

    @jax.jit
    def step(weights, state, pictures, *truth_and_tint):
        *truth, tint = truth_and_tint
        lit = pictures * tint[:, None, None, :3] + tint[:, None, None, 3:]
        value, slope = jax.value_and_grad(loss)(weights, lit, *truth)
        change, state = optimiser.update(slope, state, weights)
        return optax.apply_updates(weights, change), state, value

    return optimiser.init(weights), step


def tints(rng: np.random.Generator, count: int) -> np.ndarray:
    made = np.c_[rng.uniform(0.85, 1.15, (count, 3)), rng.uniform(-12, 12, (count, 3))]
    return made.astype(np.float32)


def trained(
    part: Part,
    pictures: np.ndarray,
    points: np.ndarray,
    epochs: int,
    seed: int,
    report: Callable[[str], None],
) -> Weights:
    """pictures: K x 64 x 64 x 3 uint8; points: K x P x 2, sides of the square."""
    weights = initial(part, points.mean(0), seed)
    steps = epochs * (len(pictures) // BATCH)
    state, step = descent(partial(loss_of, part=part), weights, steps, PEAK_RATE, DECAY)
    rng = np.random.default_rng(seed)
    for epoch in range(epochs):
        order, losses = rng.permutation(len(pictures)), []
        for first in range(0, len(order) - BATCH + 1, BATCH):
            rows = order[first : first + BATCH]
            batch = pictures[rows].astype(np.float32), points[rows], tints(rng, BATCH)
            weights, state, loss = step(weights, state, *batch)
            losses.append(float(loss))
        report(f"{part.name}: {epoch + 1} of {epochs} rounds, loss {np.mean(losses):.3f}")
    return weights


def predicted(weights: Weights, part: Part, pictures: np.ndarray) -> np.ndarray:
    """Points (K x P x 2, sides of the square) of pictures."""
    see = jax.jit(lambda batch: outputs_of(weights, standardised(batch)))
    rows = [np.asarray(see(pictures[i : i + 256])) for i in range(0, len(pictures), 256)]
    return np.concatenate(rows)[:, : 2 * len(part.groups)].reshape(len(pictures), -1, 2)
