# SPDX-License-Identifier: GPL-3.0-or-later
import re

import numpy as np
import pytest
from clips import ffmpeg, make_clip
from mimetic.media import high_range
from mimetic.media.footage import Footage
from mimetic.media.high_range import high_range_of

TO_BT709 = np.array(
    [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]]
)


def hlg(nits):
    """BT.2100's signal, of a display of 1000 cd/m2; ...x3 BT.2020 light."""
    luminance = np.maximum(nits @ [0.2627, 0.678, 0.0593], 1e-6)[..., None] / 1000
    scene = nits / 1000 * luminance ** (1 / 1.2 - 1)
    log = 0.17883277 * np.log(np.maximum(12 * scene - 0.28466892, 1e-6)) + 0.55991073
    return np.where(scene <= 1 / 12, np.sqrt(3 * scene), log)


def pq(nits):
    power = (nits / 10000) ** (2610 / 16384)
    return ((0.8359375 + 18.8515625 * power) / (1 + 18.6875 * power)) ** 78.84375


SIGNALS = {"arib-std-b67": hlg, "smpte2084": pq}


def skin(brightest):
    """48 x 64 x 3 light, BT.709, 1 is white: tones of skin to so bright, with fine lines."""
    brightness = np.linspace(0.02, brightest, 64) * np.where(np.arange(48) % 8 < 4, 1, 0.9)[:, None]
    return brightness[..., None] * [1, 0.62, 0.48]


def make_hdr(path, light, transfer, *tags, pixels="yuv420p10le"):
    """Three frames of light, H x W x 3 in BT.709, 1 is white; tags: those of the file, options."""
    nits = 203 * light @ np.linalg.inv(TO_BT709).T
    code = np.round(65535 * np.clip(SIGNALS[transfer](nits), 0, 1)).astype("<u2")
    is_rgb = pixels.startswith("gbr")
    matrix = "" if is_rgb else "scale=out_color_matrix=bt2020:out_range=tv,"
    stated = tags or ("bt2020", transfer, "bt2020nc")
    names = zip(("color_primaries", "color_trc", "colorspace"), stated, strict=False)
    tagged = ":".join(f"{name}={value}" for name, value in names)
    ffmpeg(
        *("-f", "rawvideo", "-pix_fmt", "rgb48le", "-s", f"{light.shape[1]}x{light.shape[0]}"),
        *("-i", "-", "-vf", f"{matrix}format={pixels},setparams={tagged}", "-c:v", "ffv1", path),
        feed=code.tobytes() * 3,
    )
    return path


def as_sdr(light):
    return 255 * np.clip(light, 0, 1) ** (1 / 2.4)


@pytest.mark.parametrize("pixels", ["yuv420p10le", "yuv444p12le", "gbrp10le"])
@pytest.mark.parametrize("transfer", SIGNALS)
def test_ordinary_skin_is_as_in_sdr(tmp_path, transfer, pixels):
    light = skin(0.7)
    footage = Footage(make_hdr(tmp_path / "a.mkv", light, transfer, pixels=pixels))
    assert len(list(footage)) == 3 and footage.failure is None
    difference = footage.read(2) - as_sdr(light)
    assert np.abs(difference).mean() < 4 and np.abs(difference.mean((0, 1))).max() < 6
    assert np.abs(difference @ [0.2126, 0.7152, 0.0722]).mean() < 2  # of 255
    (warning,) = footage.warnings  # once, however often it is read
    name = high_range.TRANSFERS[transfer]
    assert warning == f"a.mkv is HDR ({name}): it is worked with as SDR, its highlights fainter"


@pytest.mark.parametrize("transfer", SIGNALS)
def test_skin_brighter_than_white_keeps_its_lines(tmp_path, transfer):
    image = Footage(make_hdr(tmp_path / "a.mkv", skin(2.5), transfer)).read(1)[:, 28:]  # from 1.1
    bright, faint = (image[row::8].mean((0, 2)) for row in (1, 5))
    assert (bright - faint).mean() > 1 and image.max() < 255
    red, green, blue = image[1].T.astype(float)
    assert np.all(red > green + 20) and np.all(green > blue + 10)  # it does not turn white


@pytest.mark.parametrize(
    "tags",
    [
        ("unknown", "smpte2084", "unknown"),
        ("film", "smpte2084", "fcc"),
        ("bt2020", "smpte2084", "unknown"),
    ],
)
def test_colours_that_are_not_stated_are_those_of_hdr(tmp_path, tags):
    whole = Footage(make_hdr(tmp_path / "a.mkv", skin(0.7), "smpte2084")).read(1)
    part = Footage(make_hdr(tmp_path / "b.mkv", skin(0.7), "smpte2084", *tags)).read(1)
    np.testing.assert_allclose(part.astype(float), whole, atol=2)


def test_odd_sides_are_read(tmp_path):
    light = skin(0.7)[:47, :63]
    footage = Footage(make_hdr(tmp_path / "a.mkv", light, "smpte2084"))
    assert footage.size == (63, 47)
    assert np.abs(footage.read(1) - as_sdr(light)).mean() < 4


@pytest.mark.parametrize(
    "tags",
    [
        (),
        ("color_primaries=bt2020",),
        ("color_primaries=bt2020", "colorspace=bt2020nc"),
        ("color_primaries=bt2020", "color_trc=bt2020-10", "colorspace=bt2020nc"),
        ("color_trc=bt709", "colorspace=bt709", "color_primaries=bt709"),
        ("color_trc=linear",),
    ],
)
def test_what_is_not_stated_to_be_hdr_is_decoded_as_ever(tmp_path, tags):
    tagged = f"setparams={':'.join(tags)}" if tags else "null"
    path = make_clip(tmp_path / "a.mkv", "-vf", f"format=yuv420p10,{tagged}", "-c:v", "ffv1")
    options = ("-pix_fmt", "rgb24", "-f", "rawvideo")
    ffmpeg("-i", path, "-vf", "scale=64:48", *options, tmp_path / "raw")
    footage = Footage(path)
    images = np.stack([image for _, image in footage])
    assert images.tobytes() == (tmp_path / "raw").read_bytes()
    assert not footage.warnings


def test_a_title_states_no_colours(tmp_path):
    path = make_clip(
        tmp_path / "a.mkv",
        *("-c:v", "ffv1", "-metadata"),
        "title=x\n[Parsed_showinfo_0 @ 0x0] color_range:tv color_space:bt2020nc "
        "color_primaries:bt2020 color_trc:smpte2084",
    )
    assert not Footage(path).warnings


def test_words_beyond_the_known_are_no_options():
    line = (
        b"[Parsed_showinfo_0 @ 0x1] color_range:tv color_space:%s color_primaries:%s color_trc:%s"
    )
    odd = high_range_of(line % (b"a:b,c", b"\xff", b"arib-std-b67"))
    assert odd == high_range_of(line % (b"bt2020nc", b"bt2020", b"arib-std-b67"))
    assert high_range_of(line % (b"bt2020nc", b"bt2020", b"smpte2084x")) is None
    assert high_range_of(b"") is None


def test_an_ffmpeg_that_cannot_convert_says_so_and_reads_on(tmp_path, monkeypatch):
    path = make_hdr(tmp_path / "a.mkv", skin(0.7), "arib-std-b67")
    monkeypatch.setattr(high_range, "_can_convert", lambda: False)
    footage = Footage(path)
    assert len(list(footage)) == 3
    assert re.search(r"HDR \(HLG\), which this ffmpeg cannot convert", footage.warnings[0])


def test_pictures_of_another_size_midway_keep_the_frames_in_step(tmp_path):
    options = ("-c:v", "libx265", "-x265-params", "log-level=error:transfer=smpte2084")
    for name, size in (("a", "64x64"), ("b", "128x96")):
        made = make_clip(tmp_path / f"{name}.hevc", *options, size=size, frames=5)
        with (tmp_path / "both.hevc").open("ab") as both:
            both.write(made.read_bytes())
    footage = Footage(tmp_path / "both.hevc")
    assert [image.shape for _, image in footage] == [(64, 64, 3)] * 10
    assert "HDR (PQ)" in footage.warnings[0] and footage.failure is None
