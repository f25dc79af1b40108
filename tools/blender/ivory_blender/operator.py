"""What all operators share: they are generators that yield command lines, and are run without holding up Blender, or, in
scripts (execute), to their end."""

import bpy

from . import run
from .run import Failure


class Stopped(Exception):
    """By a person; its line says what is left."""


class IvoryOperator:
    """Subclasses have steps(context): a generator that yields (what is done, command) and is sent the run.Child that has
    ended well. It calls warn() and say(). Failure ends it."""

    @classmethod
    def poll(cls, context):
        return not run.busy()

    def steps(self, context):
        raise NotImplementedError

    def warn(self, lines):
        for line in lines:
            self.report({"WARNING"}, line)
            self._said.append("! " + line)

    def say(self, *lines):
        self._said.extend(lines)

    def execute(self, context):
        ending = self._begin(context)
        while ending is None:
            self._child.wait()
            ending = self._proceed(context)
        return ending

    def invoke(self, context, _event):
        ending = self._begin(context)
        if ending is not None:
            return ending
        self._timer = context.window_manager.event_timer_add(0.2, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if context.window_manager.ivory.stopping and not self._child.asked_to_stop:
            self._child.stop()
        ended = self._child.poll()
        self._show(context)
        return (self._proceed(context) if ended else None) or {"PASS_THROUGH"}

    def cancel(self, context):
        """Blender ends it, for it loads another file or quits; a grid leaves its checkpoint."""
        self._child.leave()
        self._leave(context)

    def _begin(self, context):
        self._said, self._timer, self._child = [], None, None
        self._steps = self.steps(context)
        context.window_manager.ivory.stopping = False
        return self._step(context, lambda: next(self._steps))

    def _proceed(self, context):
        """After a child's end: None where another one runs now, else what the operator returns."""
        child = self._child
        if child.asked_to_stop or child.code in run.STOPPED:
            return self._end(context, Stopped(child.message() if child.code else "ivory: done before it could be stopped"))
        if child.code != 0:
            return self._end(context, Failure(child.message()))
        return self._step(context, lambda: self._steps.send(child))

    def _step(self, context, advance):
        try:
            self._doing, command = advance()
            self._child = run.Child(command)
        except StopIteration:
            return self._end(context, None)
        except (Failure, OSError) as ending:
            return self._end(context, ending)
        except BaseException:
            self._leave(context)
            raise
        self._show(context)
        return None

    def _end(self, context, ending):
        self._leave(context)
        said = self._said + ([str(ending)] if ending is not None else [])
        context.window_manager.ivory.said = "\n".join(said)
        _redraw(context)
        if ending is None:
            return {"FINISHED"}
        self.report({"WARNING" if isinstance(ending, Stopped) else "ERROR"}, str(ending))
        return {"CANCELLED"}

    def _leave(self, context):
        self._steps.close()
        context.window_manager.ivory.stopping = False
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None

    def _show(self, context):
        shown = context.window_manager.ivory
        shown.text = self._child.progress.text or self._doing
        shown.fraction = 100 * self._child.progress.fraction
        _redraw(context)


def _redraw(context):
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


class IVORY_OT_stop(bpy.types.Operator):
    """Stop ivory. A grid leaves its checkpoint, and the same bake goes on from there"""
    bl_idname = "ivory.stop"
    bl_label = "Stop"

    @classmethod
    def poll(cls, context):
        return context.window_manager.ivory.running

    def execute(self, context):
        context.window_manager.ivory.stopping = True
        return {"FINISHED"}


def register():
    bpy.utils.register_class(IVORY_OT_stop)


def unregister():
    run.stop_all()
    bpy.utils.unregister_class(IVORY_OT_stop)
