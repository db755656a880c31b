// --- Mouse, fingers and wheel: they move the camera, and a click picks

/** Let the mouse, fingers and the wheel move the camera, and a click pick. */
function listen(canvas, camera, draw, { pick, at }) {
  const held = new Map();
  let moved = false;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left - box.width / 2, box.top + box.height / 2 - event.clientY];
  };
  const spread = () => {
    const [a, b] = [...held.values()];
    return { size: Math.hypot(a[0] - b[0], a[1] - b[1]), middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2] };
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    camera.stay();
    held.set(event.pointerId, place(event));
    moved = held.size > 1;
    canvas.classList.add("held");
    $("#tip").hidden = true;
  });
  canvas.addEventListener("pointermove", (event) => {
    const now = place(event);
    const under = at(...now);
    $("#readout").textContent = under ? `x ${under[0].toPrecision(7)}  y ${under[1].toPrecision(7)}` : "";
    if (!held.has(event.pointerId)) return;
    const before = held.get(event.pointerId);
    const pinch = held.size === 2 ? spread() : null;
    const dx = now[0] - before[0], dy = now[1] - before[1];
    if (!moved && Math.hypot(dx, dy) < 3) return;
    moved = true;
    held.set(event.pointerId, now);
    if (pinch) {
      const after = spread();
      camera.zoom(after.size / Math.max(pinch.size, 1), ...after.middle);
      camera.pan(after.middle[0] - pinch.middle[0], after.middle[1] - pinch.middle[1]);
    } else if (camera.flat || event.shiftKey || event.buttons > 1) camera.pan(dx, dy);
    else camera.turn(dx, -dy);
    draw();
  });
  const release = (event) => {
    if (!held.delete(event.pointerId)) return;
    canvas.classList.remove("held");
    if (moved || event.type === "pointercancel") return;
    const [x, y] = place(event);
    const words = pick(x, y);
    if (!words) return;
    const tip = $("#tip");
    tip.replaceChildren(element("b", { textContent: words[1] || words[0] }), ...(words[1] ? [element("br"), words[0]] : []));
    tip.style.left = `${x + canvas.clientWidth / 2 + 12}px`;
    tip.style.top = `${canvas.clientHeight / 2 - y + 12}px`;
    tip.hidden = false;
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    camera.stay();
    $("#tip").hidden = true;
    camera.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0016)), ...place(event));
    draw();
  }, { passive: false });
}
