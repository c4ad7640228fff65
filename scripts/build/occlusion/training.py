# SPDX-License-Identifier: GPL-3.0-or-later
"""A convolutional network that says of each cell of a picture how far it is covered; with JAX."""

from __future__ import annotations

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
import optax

from ..eyes_and_lips.training import descent, standardised, tints

# name: kind, channels in, channels out, width of the kernel, stride
LAYERS = {
    "half": ("conv", 3, 16, 3, 2),
    "quarter": ("conv", 16, 32, 3, 2),
    "quarter_2": ("conv", 32, 32, 3, 1),
    "eighth": ("conv", 32, 64, 3, 2),
    "eighth_2": ("conv", 64, 64, 3, 1),
    "sixteenth": ("conv", 64, 64, 3, 2),
    "sixteenth_2": ("conv", 64, 64, 3, 1),
    "sixteenth_3": ("conv", 64, 64, 3, 1),
    "to_eighth": ("up", 64, 64, 2, 2),
    "eighth_3": ("conv", 64, 48, 3, 1),
    "to_quarter": ("up", 48, 32, 2, 2),
    "quarter_3": ("conv", 32, 32, 3, 1),
    "covered": ("conv", 32, 1, 1, 1),
}
ADDED = {"to_eighth": "eighth_2", "to_quarter": "quarter_2"}  # an earlier layer's output
BATCH, PEAK_RATE, DECAY = 64, 2e-3, 1e-4
Weights = dict[str, dict[str, jax.Array]]


def initial(seed: int) -> Weights:
    """He's initialisation."""
    key, weights = jax.random.PRNGKey(seed), {}
    for name, (kind, inputs, outputs, width, _) in LAYERS.items():
        key, own = jax.random.split(key)
        shape = (inputs, outputs) if kind == "up" else (outputs, inputs)
        fan_in = inputs * (1 if kind == "up" else width * width)
        drawn = jnp.sqrt(2.0 / fan_in) * jax.random.normal(own, (*shape, width, width))
        weights[name] = {"w": drawn, "b": jnp.zeros(outputs)}
    return weights


def logits(weights: Weights, pictures: jax.Array) -> jax.Array:
    """pictures: B x 3 x S x S, of mean 0 and deviation 1 each -> B x C x C."""
    x, seen = pictures, {}
    for name, (kind, _, outputs, width, stride) in LAYERS.items():
        layer = weights[name]
        if kind == "up":
            parts = jnp.einsum("bihw,ioyx->bohywx", x, layer["w"])
            x = parts.reshape(len(x), outputs, 2 * x.shape[2], 2 * x.shape[3])
        else:
            pad = ((width // 2, width // 2),) * 2
            x = jax.lax.conv_general_dilated(x, layer["w"], (stride, stride), pad)
        x = x + layer["b"][:, None, None]
        if name in ADDED:
            x = x + seen[ADDED[name]]
        if name != "covered":
            x = jax.nn.relu(x)
        seen[name] = x
    return x[:, 0]


def loss_of(weights: Weights, pictures: jax.Array, covered: jax.Array, face: jax.Array):
    """Cross entropy of each cell of the face."""
    seen = logits(weights, standardised(pictures))
    off = optax.sigmoid_binary_cross_entropy(seen, covered)
    return (face * off).sum() / face.sum()


def trained(
    pictures: np.ndarray,
    covered: np.ndarray,
    face: np.ndarray,
    epochs: int,
    seed: int,
    report: Callable[[str], None],
) -> Weights:
    """pictures: K x S x S x 3 uint8; covered, face: K x C x C, 0 to 1."""
    weights = initial(seed)
    steps = epochs * (len(pictures) // BATCH)
    state, step = descent(loss_of, weights, steps, PEAK_RATE, DECAY)
    rng = np.random.default_rng(seed)
    for epoch in range(epochs):
        order, losses = rng.permutation(len(pictures)), []
        for first in range(0, len(order) - BATCH + 1, BATCH):
            rows = order[first : first + BATCH]
            tint = tints(rng, BATCH)
            batch = pictures[rows].astype(np.float32), covered[rows], face[rows]
            if rng.random() < 0.5:
                batch = tuple(each[:, :, ::-1] for each in batch)
            weights, state, loss = step(weights, state, *batch, tint)
            losses.append(float(loss))
        report(f"{epoch + 1} of {epochs} rounds, loss {np.mean(losses):.4f}")
    return weights


def predicted(weights: Weights, pictures: np.ndarray) -> np.ndarray:
    """How probably each cell is covered, K x C x C."""
    see = jax.jit(lambda batch: jax.nn.sigmoid(logits(weights, standardised(batch))))
    rows = [np.asarray(see(pictures[i : i + 128])) for i in range(0, len(pictures), 128)]
    return np.concatenate(rows)
