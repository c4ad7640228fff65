# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic._core import FlowMethod, FlowOptions, compute_flow


def make_pair(shift=2):
    rng = np.random.default_rng(1)
    image = rng.normal(0, 1, (80, 110))
    for axis in (0, 1):
        for _ in range(4):
            image = (image + np.roll(image, 1, axis)) / 2
    image = np.clip(128 + 200 * image, 0, 255).astype(np.uint8)
    return image, np.roll(image, shift, axis=1)


@pytest.mark.parametrize("method", ["probabilistic", "dis"])
def test_a_shift_to_the_right_is_flow_along_x(method):
    options = FlowOptions()
    options.method = getattr(FlowMethod, method)
    field = compute_flow(*make_pair(), options)
    assert field.flow.shape == (80, 110, 2) and field.flow.dtype == np.float32
    assert field.covariance.shape == (80, 110, 3)
    np.testing.assert_allclose(np.median(field.flow[10:-10, 10:-10], axis=(0, 1)), [2, 0], atol=0.1)


def test_the_arrays_outlive_the_field():
    flow = compute_flow(*make_pair()).flow
    again = flow.copy()
    compute_flow(*make_pair(1))
    np.testing.assert_array_equal(flow, again)


def test_other_types_and_shapes_are_refused():
    image, other = make_pair()
    with pytest.raises(TypeError):
        compute_flow(image.astype(np.float64), other)
    with pytest.raises(InvalidInput, match="height, width"):
        compute_flow(np.dstack([image] * 3), other)
    with pytest.raises(InvalidInput, match="one size"):
        compute_flow(image, other[:40])
    with pytest.raises(InvalidInput, match="initial flow"):
        compute_flow(image, other, initial=np.zeros((40, 40, 2), np.float32))
