// Turning, moving and enlarging: mouse, touch, keys.

/** Degrees a pixel. */
const TURN = 0.4;

/** Calls `changed` when the camera has moved, `clicked(x, y)` (pixels from the middle, y down) for an element, `keyed(key)` for keys
 * that do not move the camera. */
function listen(canvas, camera, changed, clicked, keyed) {
  const pointers = new Map();
  let moved = 0;
  const fromMiddle = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2];
  };
  canvas.addEventListener("pointerdown", (event) => {
    // A pointer made by a script cannot be captured.
    try { canvas.setPointerCapture(event.pointerId); } catch { /* it goes on without */ }
    pointers.set(event.pointerId, fromMiddle(event));
    if (pointers.size === 1) moved = 0;
    canvas.focus({ preventScroll: true });
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = fromMiddle(event);
    const [x, y] = [now[0] - before[0], now[1] - before[1]];
    moved += Math.abs(x) + Math.abs(y);
    const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
    if (other) {
      // Two fingers: what is under each stays under it.
      const far = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      camera.move(x / 2, y / 2);
      camera.zoom(far(now) / far(before), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
    } else if (event.shiftKey || event.buttons & 6) camera.move(x, y);
    else camera.turn(TURN * x, TURN * y);
    pointers.set(event.pointerId, now);
    changed();
  });
  const release = (event) => {
    if (pointers.delete(event.pointerId) && pointers.size === 0 && moved < 3 && event.type === "pointerup" && event.button === 0) clicked(...fromMiddle(event));
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    camera.zoom(Math.exp(-0.0015 * lines * event.deltaY), ...fromMiddle(event));
    changed();
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const arrow = arrows[event.key];
    if (arrow && event.shiftKey) camera.move(30 * arrow[0], 30 * arrow[1]);
    else if (arrow) camera.turn(5 * arrow[0], 5 * arrow[1]);
    else if (event.key === "+" || event.key === "=") camera.zoom(1.25, 0, 0);
    else if (event.key === "-") camera.zoom(0.8, 0, 0);
    else if (!keyed(event.key)) return;
    event.preventDefault();
    changed();
  });
}
