# SPDX-License-Identifier: GPL-3.0-or-later
"""What differs between Blender 4.2 and 5.2: facts with names, decided here alone."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
from idprop.types import IDPropertyGroup

ACTIONS_HAVE_SLOTS = bpy.app.version >= (4, 4, 0)
NODES_ARE_ALWAYS_USED = bpy.app.version >= (5, 0, 0)
COMPOSITOR_IS_A_GROUP = bpy.app.version >= (5, 0, 0)
SEQUENCES_ARE_STRIPS = bpy.app.version >= (4, 4, 0)
# Of a compositor's nodes, the size of what is rendered; before 4.4 that of the whole picture
RENDER_SIZE_IS_CROPPED = bpy.app.version >= (4, 4, 0)
# Whether they move a picture by half of its pixel where its side is odd and the result's is not, or
# the other way round
PIXELS_ARE_ALIGNED = bpy.app.version >= (5, 0, 0)
PROPERTIES_ARE_APART = bpy.app.version >= (5, 0, 0)  # an add-on's from those of the user's own
CLIPS_ARE_TURNED = bpy.app.version >= (4, 5, 0)  # as their files say, which phones do
STRIP_NAME_BYTES = 63  # at most, of a strip of the NLA
# Options of a property with a path that may start with // (from 4.5 on Blender warns of others)
RELATIVE_PATH = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5, 0) else set()


def imports() -> list[list]:
    """Lists of functions that are called after linking and appending; none before Blender 4.3."""
    called = getattr(bpy.app.handlers, "blend_import_post", None)
    return [] if called is None else [called]


def use_nodes(owner: bpy.types.Material | bpy.types.World) -> bpy.types.NodeTree:
    """The node tree of a material or world, switched on where that is still a choice."""
    if not NODES_ARE_ALWAYS_USED:
        owner.use_nodes = True
    return owner.node_tree


def leave_tweak_mode(id_block: bpy.types.ID) -> None:
    """Closes a strip of `id_block` that is open in the NLA (Tab): as long as one is, Blender
    refuses other actions, and crashes once the strip is gone. Edits are its action's, and stay."""
    animation = id_block.animation_data
    if animation is not None and animation.use_tweak_mode:
        animation.use_tweak_mode = False


def animation_of(id_block: bpy.types.ID) -> bpy.types.AnimData:
    """Animation data that takes another action; made if there is none."""
    leave_tweak_mode(id_block)
    return id_block.animation_data or id_block.animation_data_create()


def unassign(id_block: bpy.types.ID) -> None:
    """Has no action move `id_block` but those of strips."""
    if id_block.animation_data is not None:
        animation_of(id_block).action = None


def new_action(name: str, id_block: bpy.types.ID) -> bpy.types.Action:
    """An empty action, assigned to `id_block`."""
    action = bpy.data.actions.new(name)
    animation = animation_of(id_block)
    animation.action = action
    if ACTIONS_HAVE_SLOTS:
        slot = action.slots.new(id_block.id_type, id_block.name)
        strip = action.layers.new("Layer").strips.new(type="KEYFRAME")
        strip.channelbag(slot, ensure=True)
        animation.action_slot = slot
    return action


def assign_action(id_block: bpy.types.ID, action: bpy.types.Action, name: str) -> None:
    """Gives `id_block` a copy of its action, named anew, with the curves it read before."""
    animation = animation_of(id_block)
    slot = (
        animation.action_slot.identifier if ACTIONS_HAVE_SLOTS and animation.action_slot else None
    )
    action.name = name
    animation.action = action
    if not ACTIONS_HAVE_SLOTS:
        return
    same = next((s for s in action.slots if s.identifier == slot), None)
    animation.action_slot = same or action.slots.new(id_block.id_type, id_block.name)
    if not action.layers:
        action.layers.new("Layer").strips.new(type="KEYFRAME")
    action.layers[0].strips[0].channelbag(animation.action_slot, ensure=True)


def join_action(action: bpy.types.Action, id_block: bpy.types.ID) -> bool:
    """Has an action move `id_block` too, by a slot of its own; whether actions can do that."""
    if not ACTIONS_HAVE_SLOTS:
        return False
    animation = animation_of(id_block)
    slot = action.slots.new(id_block.id_type, id_block.name)
    animation.action = action
    animation.action_slot = slot
    action.layers[0].strips[0].channelbag(slot, ensure=True)
    return True


def curves(id_block: bpy.types.ID):
    """The holder of `fcurves` and `groups` that moves `id_block`, or None."""
    animation = id_block.animation_data
    if animation is None or animation.action is None:
        return None
    if not ACTIONS_HAVE_SLOTS:
        return animation.action
    for layer in animation.action.layers:
        for strip in layer.strips:
            if animation.action_slot and (bag := strip.channelbag(animation.action_slot)):
                return bag
    return None


def new_curve(holder, data_path: str, index: int, group: str) -> bpy.types.FCurve:
    """A curve in what `curves` gave, listed under a group."""
    curve = holder.fcurves.new(data_path, index=index)
    curve.group = holder.groups.get(group) or holder.groups.new(group)
    return curve


def free_action(name: str, id_type: str):
    """An empty action for data of a type ("KEY"), assigned to nothing; and its holder of curves."""
    action = bpy.data.actions.new(name)
    if not ACTIONS_HAVE_SLOTS:
        action.id_root = id_type
        return action, action
    slot = action.slots.new(id_type, name)
    strip = action.layers.new("Layer").strips.new(type="KEYFRAME")
    return action, strip.channelbag(slot, ensure=True)


def curves_in(action: bpy.types.Action) -> list[bpy.types.FCurve]:
    """All curves of an action, whatever it is assigned to."""
    if not ACTIONS_HAVE_SLOTS:
        return list(action.fcurves)
    strips = (strip for layer in action.layers for strip in layer.strips)
    return [curve for strip in strips for bag in strip.channelbags for curve in bag.fcurves]


def slot_of(user: bpy.types.AnimData | bpy.types.NlaStrip) -> str:
    """Identifier of the slot by which an action moves what it is assigned to; "" without slots."""
    slot = user.action_slot if ACTIONS_HAVE_SLOTS else None
    return slot.identifier if slot else ""


def handle_of(action: bpy.types.Action, slot: str) -> int:
    """By which a slot that `slot_of` named is known again after it was renamed; 0 without one."""
    found = action.slots.get(slot) if ACTIONS_HAVE_SLOTS else None
    return found.handle if found else 0


def slot_now(action: bpy.types.Action, slot: str, handle: int = 0) -> str | None:
    """Identifier that a slot has now, which had another before it was renamed; "" before Blender
    4.4, and None where the action no longer has it.

    handle: what `handle_of` gave, 0 where that is not known. An identifier begins with the kind of
    data that it moves, and is "" of actions that were made before there were slots.
    """
    if not ACTIONS_HAVE_SLOTS:
        return ""
    fitting = [one for one in action.slots if not slot or one.identifier[:2] == slot[:2]]
    for one in fitting:
        if handle and one.handle == handle:
            return one.identifier
    if any(one.identifier == slot for one in fitting):
        return slot
    return fitting[0].identifier if len(fitting) == 1 else None


def assign(id_block: bpy.types.ID, action: bpy.types.Action, slot: str) -> None:
    """Has an action move `id_block`, by a slot that `slot_of` named."""
    animation = animation_of(id_block)
    animation.action = action
    if ACTIONS_HAVE_SLOTS:
        animation.action_slot = action.slots.get(slot)


def curves_of(action: bpy.types.Action, slot: str) -> list[bpy.types.FCurve]:
    """The curves of one slot of an action, whatever it is assigned to."""
    if not ACTIONS_HAVE_SLOTS:
        return list(action.fcurves)
    strips = (strip for layer in action.layers for strip in layer.strips)
    bags = (bag for strip in strips for bag in strip.channelbags)
    return [curve for bag in bags if bag.slot.identifier == slot for curve in bag.fcurves]


def paths_of(action: bpy.types.Action, slot: str) -> set[str]:
    """Data paths of the curves of one slot of an action."""
    return {curve.data_path for curve in curves_of(action, slot)}


def left_references(id_block: bpy.types.ID) -> int:
    """How many of the users of a data-block are the copies of our properties that Blender leaves
    among an object's own ones, for earlier versions, when it opens a file of those."""
    if not PROPERTIES_ARE_APART:
        return 0
    users = bpy.data.user_map(subset=[id_block])[id_block]
    return sum(_references([user.get("mimetic")], id_block) for user in users)


def _references(values: Iterable, id_block: bpy.types.ID) -> int:
    """How often custom properties, and those in them, refer to a data-block."""
    count = 0
    for value in values:
        if isinstance(value, list):
            count += _references(value, id_block)
        elif isinstance(value, IDPropertyGroup):
            count += _references(value.values(), id_block)
        else:
            count += value == id_block
    return count


def add_strip(
    track: bpy.types.NlaTrack, name: str, start: float, action: bpy.types.Action, slot: str = ""
):
    """A strip that plays an action, by its first slot if none is named, on what the track is of."""
    # Blender cuts longer names within a letter, and what it then has for a name cannot be read
    short = name.encode()[:STRIP_NAME_BYTES].decode(errors="ignore")
    strip = track.strips.new(short, int(start), action)
    if ACTIONS_HAVE_SLOTS and action.slots:
        strip.action_slot = action.slots.get(slot) or action.slots[0]
    length = strip.frame_end - strip.frame_start
    strip.frame_start = start  # whole frames alone by the call above
    strip.frame_end = start + length
    return strip


def add_sound(scene: bpy.types.Scene, name: str, path: str, frame: float):
    """A strip of sound that begins at a scene frame, which need not be whole, on a free channel."""
    editor = scene.sequence_editor_create()
    strips = editor.strips if SEQUENCES_ARE_STRIPS else editor.sequences
    channel = 1 + max((strip.channel for strip in strips), default=0)
    strip = strips.new_sound(name, path, channel, int(frame))
    strip.frame_start = frame
    return strip


def follow(
    owner: bpy.types.ID, path: str, source: bpy.types.ID, source_type: str, source_path: str
) -> None:
    """Has a property take the value of another one, by a driver that runs no script."""
    driver = owner.driver_add(path).driver
    driver.type = "SUM"
    variable = driver.variables.new()
    variable.type = "SINGLE_PROP"
    variable.targets[0].id_type = source_type
    variable.targets[0].id = source
    variable.targets[0].data_path = source_path


def compute(
    owner: bpy.types.ID,
    path: str,
    source: bpy.types.ID,
    source_type: str,
    variables: dict[str, str],
    expression: str,
) -> None:
    """Has a property follow a formula of another one's (variables by name: their paths).

    It must be so simple that Blender computes it without running a script.
    """
    driver = owner.driver_add(path).driver
    for name, source_path in variables.items():
        variable = driver.variables.new()
        variable.name, variable.type = name, "SINGLE_PROP"
        variable.targets[0].id_type = source_type
        variable.targets[0].id = source
        variable.targets[0].data_path = source_path
    driver.expression = expression


def compositor(scene: bpy.types.Scene) -> bpy.types.NodeTree | None:
    """The nodes that make a picture of what was rendered, if the scene has any."""
    return scene.compositing_node_group if COMPOSITOR_IS_A_GROUP else scene.node_tree


def new_compositor(scene: bpy.types.Scene, name: str):
    """An empty tree of a scene that has none, in use; and the socket that takes the picture."""
    if COMPOSITOR_IS_A_GROUP:
        tree = bpy.data.node_groups.new(name, "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        scene.compositing_node_group = tree
        return tree, tree.nodes.new("NodeGroupOutput").inputs[0]
    scene.use_nodes = True
    scene.node_tree.nodes.clear()
    return scene.node_tree, scene.node_tree.nodes.new("CompositorNodeComposite").inputs[0]


def stretch_to_render(node: bpy.types.Node) -> None:
    """Has a compositor's Scale node make its picture as large as what is rendered."""
    if COMPOSITOR_IS_A_GROUP:
        node.inputs["Type"].default_value = "Render Size"
        node.inputs["Frame Type"].default_value = "Stretch"
    else:
        node.space = "RENDER_SIZE"
        node.frame_method = "STRETCH"


def alpha_over(node: bpy.types.Node):
    """The sockets of an Alpha Over node: what is behind, what lies over it."""
    if COMPOSITOR_IS_A_GROUP:
        return node.inputs["Background"], node.inputs["Foreground"]
    return node.inputs[1], node.inputs[2]


def usd_textures_stay() -> dict[str, object]:
    """Options of the USD exporter with which pictures are referred to where they are."""
    if "export_textures_mode" in bpy.ops.wm.usd_export.get_rna_type().properties:  # from 4.4 on
        return {"export_textures_mode": "KEEP"}
    return {"export_textures": False}
