# SPDX-License-Identifier: GPL-3.0-or-later
"""Which expression a button means: one by name, the Asset Browser's, or the panel's."""

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty

from .. import native, scene_out, targets
from ..greyed import Greyed

# Of an action that was appended: the path of the other file with its name there. By the name alone
# an expression of this file, or of another library, would be taken for it
ORIGIN = "mimetic_origin"


class OfExpression(Greyed):
    """Mixin of operators on an expression."""

    action: StringProperty(options={"SKIP_SAVE"}, description="Expression; the chosen one if empty")

    obstacle = staticmethod(targets.no_expression)


class OnFace(OfExpression):
    """Mixin of operators that put an expression on a face."""

    obstacle = staticmethod(targets.no_expression_on_face)


def chosen(context, name: str) -> bpy.types.Action:
    """The expression as an action of this file, appended if need be; raises InvalidInput."""
    asset = getattr(context, "asset", None)
    if name:
        action = bpy.data.actions.get(name)
    elif asset is not None:
        action = asset.local_id if asset.local_id is not None else _appended(asset)
    else:
        action = context.scene.mimetic.expression
    if not isinstance(action, bpy.types.Action) or not scene_out.expressions.is_expression(action):
        what = name or (asset.name if asset else "")
        if not what:
            raise native.invalid_input(rpt_("Choose an expression"))
        raise native.invalid_input(
            rpt_("{name} is no expression: choose one that was kept").format(name=what)
        )
    return action


def _appended(asset) -> bpy.types.Action | None:
    """The asset of another file; what was appended from there before is used again."""
    if asset.id_type != "ACTION":
        return None
    for action in bpy.data.actions:
        if action.get(ORIGIN) == asset.full_path:
            return action
    try:
        with bpy.data.libraries.load(asset.full_library_path, link=False) as (there, here):
            here.actions = [name for name in there.actions if name == asset.name]
    except OSError as error:
        raise native.invalid_input(
            rpt_("{name} cannot be read: {error}").format(name=asset.name, error=error)
        ) from None
    if not here.actions:
        return None
    here.actions[0][ORIGIN] = asset.full_path
    return here.actions[0]
