// --- Numbers of the page: see packing.py

/** Return the whole numbers (count) that the element `id` holds, as doubles. */
async function unpacked(id) {
  const element = document.getElementById(id);
  const count = Number(element.dataset.count), width = Number(element.dataset.width);
  const packed = Uint8Array.from(atob(element.textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  element.remove();
  const numbers = new Float64Array(count);
  for (let n = 0, last = 0; n < count; n++) {
    let plain = 0;
    for (let byte = width - 1; byte >= 0; byte--) plain = plain * 256 + bytes[byte * count + n];
    last += plain % 2 ? -(plain + 1) / 2 : plain / 2;
    numbers[n] = last;
  }
  return numbers;
}

/** Return the coordinates x, y, z of all nodes, each (count); z is 0 in the plane. */
async function coordinates(facts) {
  const [low] = facts.box;
  const axes = await Promise.all(low.map(async (least, axis) => {
    const numbers = await unpacked("xyz"[axis]);
    return numbers.map((steps) => least + steps * facts.step);
  }));
  return axes.length === 3 ? axes : [...axes, new Float64Array(axes[0].length)];
}
