# SPDX-License-Identifier: GPL-3.0-or-later
import pytest
from mimetic.shared.folder_lock import in_use, remove_left_over
from mimetic.shared.whole_file import TEXTURES, file_with_textures, whole_file


def put(path, *pictures):
    with file_with_textures(path) as aside:
        assert aside.name == path.name and not aside.exists()
        aside.write_text("file")
        folder = aside.with_name(aside.name + TEXTURES)
        for picture in pictures:
            folder.mkdir(exist_ok=True)
            (folder / picture).write_text("picture")
        aside.with_name("rest").write_text("of no use later")


def found(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_a_file_takes_its_textures_along_and_an_earlier_ones_go(tmp_path):
    path = tmp_path / "hero.usdc"
    put(path, "a.png", "b.png")
    put(tmp_path / "other.usdc", "c.png")
    other = ["other.usdc", "other.usdc.textures", "other.usdc.textures/c.png"]
    put(path, "b.png")
    hero = ["hero.usdc", "hero.usdc.textures", "hero.usdc.textures/b.png"]
    assert found(tmp_path) == [*hero, *other]
    put(path)
    assert found(tmp_path) == ["hero.usdc", *other]


def test_a_file_that_fails_leaves_all_as_it_was(tmp_path):
    path = tmp_path / "hero.usdc"
    put(path, "a.png")
    before = found(tmp_path)
    with pytest.raises(ValueError, match="stop"), file_with_textures(path) as aside:
        aside.write_text("half")
        raise ValueError("stop")
    assert found(tmp_path) == before and path.read_text() == "file"
    with pytest.raises(OSError, match=r"nowhere/hero\.usdc"):
        put(tmp_path / "nowhere" / "hero.usdc")


def test_a_folder_that_is_gone_is_told_by_the_name_that_was_given(tmp_path):
    path = tmp_path / "gone" / "hero.json"
    with pytest.raises(FileNotFoundError) as raised, whole_file(path):
        pass
    assert raised.value.filename == str(path)


@pytest.mark.parametrize("beside", [whole_file, file_with_textures])
def test_what_is_being_written_is_not_left_over(tmp_path, beside):
    with beside(tmp_path / "face.glb") as at_work:
        remove_left_over(tmp_path.iterdir())
        if beside is whole_file:
            at_work.write(b"whole")
        else:
            at_work.write_bytes(b"whole")
    assert (tmp_path / "face.glb").read_bytes() == b"whole"
    assert found(tmp_path) == ["face.glb"]


def test_what_is_removed_before_it_is_locked_is_made_again(tmp_path):
    names = iter(["taken for left over", "made again"])

    def make():
        path = tmp_path / next(names)
        if path.name == "made again":
            path.mkdir()
        return str(path)

    with in_use(make) as path:
        assert path == str(tmp_path / "made again")
