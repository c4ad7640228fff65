# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from clips import make_clip
from mimetic.media.footage import Footage


@pytest.mark.parametrize(("frames", "last"), [(12, 5), (33, 6), (60, 6)])
def test_gaps_at_a_short_clips_end_leave_its_rate(tmp_path, frames, last):
    """As a file cut off in the middle of a group lists its frames."""
    kept = f"select=lt(n\\,{frames - last})+not(mod(n-{frames}\\,2))"
    output = ("-vf", kept, "-fps_mode", "passthrough", "-c:v", "ffv1")
    footage = Footage(make_clip(tmp_path / "a.mkv", *output, rate="30", frames=frames - last // 2))
    assert np.diff(footage.times).max() > 0.06
    assert footage.fps == 30 and not footage.warnings


@pytest.mark.parametrize(
    "times", ["N*(1+N/40)", "N+0.5*mod(N\\,2)", "N+0.5*gt(N\\,14)", "if(lt(N\\,10)\\,N\\,1.5*N-5)"]
)
def test_short_clips_of_a_variable_rate_say_so(tmp_path, times):
    output = ("-vf", f"settb=1/1000,setpts=40*({times})", "-fps_mode", "passthrough")
    output += ("-enc_time_base", "1:1000", "-c:v", "ffv1")
    footage = Footage(make_clip(tmp_path / "a.mkv", *output, frames=20))
    assert footage.variable_rate and "variable rate" in footage.warnings[0]
