"""Gaze from irises: saccades, fixations, blinks, eyes that are not seen, lids that go along."""

from types import SimpleNamespace

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.performance.rows import Rows
from mimetic.solve.gaze import ClipGaze
from mimetic.template.face_template import load_template

CAMERA = _core.Camera(600.0, 600.0, 319.5, 239.5, 640, 480)
CENTERS = np.array([[0.0315, 0.028, 0.071], [-0.0315, 0.028, 0.071]])
RADIUS = 0.0168
FACING = np.array([[0.3, 0, 1.0], [-0.3, 0, 1.0]])
SIDE = 70.0  # pixels of the network's crop
FPS = 30.0


def pose_of(yaw=0.0):
    """Camera from head, turned to the subject's left by degrees."""
    c, s = np.cos(np.radians(yaw)), np.sin(np.radians(yaw))
    pose = np.eye(4)
    pose[:3, :3] = np.diag([1.0, -1, -1]) @ [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    pose[2, 3] = 0.7
    return pose


def irises_of(angles, poses, opening=0.8):
    """N x 2 x 6 as the tracker gives them, of gazes N x 4."""
    angles = shown(angles)
    rows = np.zeros((len(angles), 2, 6))
    for t, pose in enumerate(poses):
        for eye in (0, 1):
            front = _core.gaze_direction(*angles[t, 2 * eye : 2 * eye + 2])
            point = pose[:3, :3] @ (CENTERS[eye] + RADIUS * front) + pose[:3, 3]
            pixel = np.array(CAMERA.pixels((CENTERS[eye] + RADIUS * front)[None], pose))[0]
            assert point[2] > 0
            rows[t, eye] = [*pixel, SIDE, opening, 1.0, 1.0]
    return rows


def shown(angles):
    """What the network shows of turns (N x 4) about where the eyes usually are."""
    about = np.sort(angles, axis=0)[len(angles) // 2]
    return about + (angles - about) * np.array([0.9, 0.8, 0.9, 0.8])


def eyes_looking(yaw, pitch, vergence=2.0):
    """N x 4: both eyes at these (N), crossed by the usual vergence."""
    yaw, pitch = np.broadcast_arrays(np.asarray(yaw, float), np.asarray(pitch, float))
    return np.stack([yaw - vergence / 2, pitch, yaw + vergence / 2, pitch], axis=1)


def follow(irises, poses, covariance=1e-9, scene_starts=()):
    count = len(irises)
    covariances = np.tile(covariance * np.eye(6), (count, 1, 1))
    eyes = _core.Eyeballs(CENTERS, np.full(2, RADIUS), FACING)
    return _core.follow_gaze(
        CAMERA, eyes, np.ascontiguousarray(poses), covariances, irises, FPS, scene_starts
    )


def seen(track):
    """Gaze and rest together: what the pictures show."""
    return track.angles + track.rest


def test_a_saccade_is_followed_in_its_frame():
    yaw = np.where(np.arange(60) < 30, -10.0, 10.0)
    angles, poses = eyes_looking(yaw, 0.0), np.tile(pose_of(), (60, 1, 1))
    track = follow(irises_of(angles, poses), poses)
    np.testing.assert_allclose(seen(track), angles, atol=1.0)
    moved = np.diff(track.angles[:, 0])
    assert moved[29] == pytest.approx(20, abs=1)
    assert np.abs(np.delete(moved, 29)).max() < 0.5


def test_a_fixation_does_not_jitter():
    rng = np.random.default_rng(3)
    angles, poses = eyes_looking(np.full(90, 6.0), -4.0), np.tile(pose_of(), (90, 1, 1))
    irises = irises_of(angles, poses)
    irises[..., :2] += rng.normal(0, 0.0009 * SIDE, (90, 2, 2))  # the networks' own
    measured = np.diff(follow(irises[:1].repeat(90, 0), poses).angles[:, 0])
    assert np.abs(measured).max() < 1e-6
    track = follow(irises, poses)
    assert np.diff(track.angles, axis=0).std() < 0.06  # degrees a frame
    np.testing.assert_allclose(seen(track).mean(axis=0), angles[0], atol=0.2)


def test_a_blink_is_no_look_downwards():
    angles, poses = eyes_looking(np.zeros(40), 0.0), np.tile(pose_of(), (40, 1, 1))
    irises = irises_of(angles, poses)
    irises[18:22, :, 1] += 8  # what is left of an iris under a closing lid is its lower part
    irises[18:22, :, 3] = 0.1
    track = follow(irises, poses)
    assert np.abs(track.angles[:, 1] - track.angles[5, 1]).max() < 0.5
    assert track.std[20, 1] > track.std[5, 1] + 0.02


def blinking(irises, first=20, count=9, downwards=11.0):
    """Lids that come down and take what is seen of the irises along, as networks see it."""
    closure = np.sin(np.pi * np.arange(1, count + 1) / (count + 1)) ** 2
    pixels = CAMERA.fy * RADIUS / 0.63 * np.radians(downwards)
    irises = irises.copy()
    irises[first : first + count, :, 3] *= 1 - 0.7 * closure[:, None]
    irises[first : first + count, :, 1] += pixels * closure[:, None]
    return irises


def test_lids_that_come_down_for_some_frames_take_no_gaze_along():
    poses = np.tile(pose_of(), (60, 1, 1))
    track = follow(blinking(irises_of(eyes_looking(np.zeros(60), 0.0), poses)), poses)
    assert np.abs(track.angles[:, 1] - track.angles[5, 1]).max() < 1.5


def test_a_look_downwards_with_lids_that_go_along_is_followed():
    pitch = np.where((np.arange(90) >= 40) & (np.arange(90) < 55), -20.0, 0.0)
    angles, poses = eyes_looking(np.zeros(90), pitch), np.tile(pose_of(), (90, 1, 1))
    irises = irises_of(angles, poses)
    irises[40:55, :, 3] *= 0.6
    np.testing.assert_allclose(seen(follow(irises, poses))[:, 1], pitch, atol=1.5)


def test_a_head_that_turns_does_not_turn_the_eyes():
    yaw = 30 * np.sin(np.linspace(0, 2 * np.pi, 80))
    poses = np.stack([pose_of(y) for y in yaw])
    angles = eyes_looking(np.zeros(80), 0.0)
    track = follow(irises_of(angles, poses), poses)
    assert np.ptp(track.angles, axis=0).max() < 0.3


def test_eyes_that_look_into_the_camera_keep_it_while_the_head_turns():
    head = np.linspace(-20, 20, 60)
    poses = np.stack([pose_of(y) for y in head])
    angles = eyes_looking(-head, 0.0)
    track = follow(irises_of(angles, poses), poses)
    in_world = track.angles[:, [0, 2]].mean(axis=1) + head
    assert np.ptp(in_world) < 1.2  # the first and the last frame have one neighbour


def test_eyes_that_cross_throughout_are_at_rest_so():
    """The angle kappa, or a fitted eyeball a millimetre off, would else be a squint."""
    angles, poses = eyes_looking(np.full(300, 0.0), -4.0, 11.0), np.tile(pose_of(), (300, 1, 1))
    track = follow(irises_of(angles, poses), poses)
    vergence = track.angles[:, 2] - track.angles[:, 0]
    assert np.abs(vergence - 2).max() < 1
    assert np.abs(track.angles[:, 1]).max() < 1  # where fitted eyes usually stand
    np.testing.assert_allclose(seen(track), angles, atol=0.3)
    assert (track.std > track.rest_std - 1e-9).all()
    assert (track.rest_std > 1).all()  # it is told that it is not known


def test_an_eye_beyond_the_nose_is_not_measured_and_goes_with_the_other():
    poses = np.tile(pose_of(65), (30, 1, 1))
    angles = eyes_looking(np.zeros(30), 0.0)
    irises = irises_of(angles, poses)
    irises[:, 0, 0] += 40  # nonsense at the far eye
    near, far = irises.copy(), irises
    near[:, 0, 2] = 0
    np.testing.assert_allclose(follow(far, poses).angles, follow(near, poses).angles, atol=1e-9)


def test_what_doubts_its_irises_is_believed_less():
    poses = np.tile(pose_of(), (60, 1, 1))
    irises = irises_of(eyes_looking(np.full(60, 5.0), 0.0), poses)
    doubted = irises.copy()
    doubted[..., 5] = 4.0
    sure, unsure = follow(irises, poses), follow(doubted, poses)
    assert (unsure.std[:, 0] > 1.02 * sure.std[:, 0]).all()


def test_without_an_iris_nothing_is_claimed():
    poses = np.tile(pose_of(), (20, 1, 1))
    track = follow(np.zeros((20, 2, 6)), poses)
    np.testing.assert_allclose(track.angles, eyes_looking(np.zeros(20), 0.0), atol=1e-6)
    assert (track.std > 5).all()


def test_gaze_needs_as_many_irises_as_poses():
    poses = np.tile(pose_of(), (20, 1, 1))
    with pytest.raises(InvalidInput, match="same number"):
        follow(np.zeros((19, 2, 6)), np.ascontiguousarray(poses[:20]))


def test_lids_that_go_along_are_open_and_shut_lids_are_shut():
    lid = _core.LidFollowing(0.02, 0.0)
    down = np.array([0.0, -20.0, -20.0, 20.0])
    closure = np.array([0.0, 0.4, 1.0, 1.0])
    own = lid.own(closure, down)
    np.testing.assert_allclose(own, [0, 0, 1, 1], atol=1e-12)
    np.testing.assert_allclose(lid.seen(own, down), closure, atol=1e-12)


def filtered(irises, poses, covariance=1e-9):
    live = _core.GazeFilter(_core.Eyeballs(CENTERS, np.full(2, RADIUS), FACING))
    spread = covariance * np.eye(6)
    rows = zip(poses, irises, strict=True)
    return np.array([live.advance(CAMERA, pose, spread, seen, 1 / FPS) for pose, seen in rows])


def test_a_live_saccade_is_followed_within_a_frame_and_fixations_are_still():
    yaw = np.where(np.arange(240) % 60 < 30, -8.0, 8.0)
    angles = eyes_looking(yaw, np.zeros(240))
    poses = [pose_of()] * 240
    irises = irises_of(angles, poses)
    irises[:, :, :2] += np.random.default_rng(5).normal(0, 0.15, (240, 2, 2))
    live = filtered(irises, poses)
    settled = np.arange(240) >= 120
    steps = np.flatnonzero(np.diff(yaw) != 0) + 1
    for step in steps[steps >= 120]:
        jump = live[step, 0] - live[step - 1, 0]
        assert abs(jump) > 0.85 * 16
    still = settled & (np.arange(240) % 30 > 3)
    assert np.std(live[still, 0] - yaw[still]) < 0.6


def test_a_live_gaze_stays_while_the_lids_are_shut():
    poses = [pose_of()] * 60
    irises = irises_of(eyes_looking(np.full(60, 6.0), 0.0), poses)
    irises[40:50] = 0
    live = filtered(irises, poses)
    assert np.abs(live[40:50] - live[39]).max() < 1e-9


def test_a_live_gaze_stays_while_the_lids_come_down():
    poses = [pose_of()] * 60
    live = filtered(blinking(irises_of(eyes_looking(np.zeros(60), 0.0), poses)), poses)
    assert np.abs(live[20:29, 1] - live[19, 1]).max() < 3


def test_an_eye_that_is_seen_later_has_its_lids_known_from_its_first_frame():
    poses = [pose_of()] * 90
    irises = blinking(irises_of(eyes_looking(np.zeros(90), 0.0), poses), first=60)
    irises[:50, 0] = 0
    live = filtered(irises, poses)
    assert np.abs(live[60:69, 1] - live[59, 1]).max() < 3


def test_both_eyes_follow_a_correction_of_one_and_saccades_stay():
    angles = eyes_looking(np.where(np.arange(60) < 30, 0.0, 8.0), 0.0)
    # Frame, angle, degrees, standard deviation, reach
    corrected = _core.corrected_gaze(angles, [(20, 0, 9.0, 0.5, 15.0), (20, 1, -5.0, 0.5, 15.0)])
    moved = corrected - angles
    np.testing.assert_allclose(corrected[20, :2], [9, -5], atol=0.1)
    np.testing.assert_allclose(moved[20, 2:], moved[20, :2], rtol=0.1)
    assert not moved[[4, 5, 35, 59]].any()
    assert (np.diff(moved[20:35, 0]) < 0).all()
    step = corrected[30, 0] - corrected[29, 0]
    assert step > 7


def test_an_uncertain_correction_is_met_less():
    angles = eyes_looking(np.zeros(9), 0.0)
    sure, unsure = (
        _core.corrected_gaze(angles, [(4, 1, 10.0, std, 4.0)])[4, 1] for std in (1.0, 15.0)
    )
    assert sure > 9.9 and 4 < unsure < 6


def test_corrected_eyes_stay_within_what_eyes_can_do():
    angles = eyes_looking(np.full(5, 45.0), 30.0)
    pins = [(2, 0, 50.0, 0.1, 8.0), (2, 1, 50.0, 0.1, 8.0)]
    corrected = _core.corrected_gaze(angles, pins)
    assert corrected[:, ::2].max() <= 50 and corrected[:, 1::2].max() <= 40


@pytest.mark.parametrize(
    "pin",
    [(5, 0, 0, 1, 8), (0, 4, 0, 1, 8), (0, 0, np.nan, 1, 8), (0, 0, 0, 0, 8), (0, 0, 0, 1, 0)],
)
def test_corrections_of_no_gaze_are_refused(pin):
    with pytest.raises(InvalidInput, match="correction of the gaze"):
        _core.corrected_gaze(np.zeros((5, 4)), [pin])


@pytest.mark.parametrize("first", [60, 1])
def test_lids_are_told_by_the_gaze_of_the_fitted_frame_even_outside_of_the_range(first):
    """Who looks down throughout a shot was fitted looking up, before it or behind it."""
    count, fitted = 30, 40
    rows = Rows(
        frame=list(range(first, first + count)),
        pose=[pose_of()] * count,
        pose_cov=[1e-9 * np.eye(6)] * count,
        irises=list(irises_of(eyes_looking(np.zeros(count), -15.0), [pose_of()] * count)),
    )
    (upwards,) = irises_of(eyes_looking(np.zeros(1), 0.0), [pose_of()])
    at_fit = SimpleNamespace(camera_from_head=pose_of(), pose_cov=1e-9 * np.eye(6), irises=upwards)
    template = load_template()
    fit = SimpleNamespace(
        frame=fitted, camera=CAMERA, neutral_vertices=lambda template: template.vertices
    )
    gaze = ClipGaze(fit, template, rows, at_fit, FPS)
    assert gaze.angles.shape == gaze.std.shape == (count, 4)
    apart = gaze.following[0].rest_pitch - gaze.angles[:, 1]
    assert (np.abs(apart - 15) < 6).all()  # the template's eyeballs are smaller than these


@pytest.mark.parametrize("num_unseen", [0, 6, 20])
def test_nothing_is_smoothed_or_bridged_over_a_cut(num_unseen):
    count, cut = 120, 60
    yaw = np.where(np.arange(count) < cut, -10.0, 10.0)
    angles, poses = eyes_looking(yaw, 0.0), np.tile(pose_of(), (count, 1, 1))
    irises = irises_of(angles, poses)
    irises[cut - num_unseen : cut] = 0
    whole = follow(irises, poses, scene_starts=[cut])
    np.testing.assert_allclose(seen(whole)[:cut, [0, 2]], angles[:cut, [0, 2]], atol=1.5)
    np.testing.assert_allclose(seen(whole)[cut:, [0, 2]], angles[cut:, [0, 2]], atol=1.5)
    # What is not known grows to the scene's end, whatever is seen behind it
    if num_unseen:
        assert (np.diff(whole.std[cut - num_unseen : cut, 0]) > 0).all()


def test_a_scene_without_eyes_stands_as_the_others():
    count = 90
    angles, poses = eyes_looking(np.full(count, 6.0), 3.0), np.tile(pose_of(), (count, 1, 1))
    irises = irises_of(angles, poses)
    irises[40:60] = 0
    track = follow(irises, poses, scene_starts=[40, 60])
    np.testing.assert_allclose(seen(track)[40:60], angles[40:60], atol=1.5)
    assert track.std[50, 0] > 3 * track.std[20, 0]


def test_a_scene_that_starts_outside_the_clip_is_refused():
    angles, poses = eyes_looking(np.zeros(5), 0.0), np.tile(pose_of(), (5, 1, 1))
    with pytest.raises(InvalidInput, match="a scene starts at frame 5 of 5"):
        follow(irises_of(angles, poses), poses, scene_starts=[5])
