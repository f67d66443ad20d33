// SPDX-License-Identifier: Apache-2.0
// Draws the boxes of the ranks over the image, with the camera of that image.

export function colourOf(rank) {
  return `hsl(${(28 + rank * 137.508) % 360} 75% 60%)`;  // golden angle: neighbours differ in colour
}

function projected(matrix, [x, y, z]) {
  return [0, 4, 8, 12].map(row => matrix[row] * x + matrix[row + 1] * y + matrix[row + 2] * z + matrix[row + 3]);
}

// Returns the part of a segment that is in front of the eye.
function visible(a, b) {
  const least = 1e-4;
  if (a[3] < least && b[3] < least) return null;
  const between = (from, to) => {
    const share = (least - from[3]) / (to[3] - from[3]);
    return from.map((value, k) => value + share * (to[k] - value));
  };
  return [a[3] < least ? between(a, b) : a, b[3] < least ? between(b, a) : b];
}

export function drawBoxes(canvas, matrix, ranks) {
  const context = canvas.getContext('2d');
  context.clearRect(0, 0, canvas.width, canvas.height);
  if (!matrix) return;
  const place = ([x, y, , w]) => [(x / w + 1) / 2 * canvas.width, (1 - y / w) / 2 * canvas.height];
  context.lineWidth = Math.max(1.25, canvas.width / 700);
  ranks.forEach((rank, number) => {
    const [low, high] = rank.box;
    if (high.some((value, k) => value <= low[k])) return;
    // Drawn slightly inside, so that adjacent faces of two boxes can be distinguished.
    const inset = 0.003;
    const corners = Array.from({length: 8}, (_, i) => projected(matrix,
      [0, 1, 2].map(k => i >> k & 1 ? high[k] - inset : low[k] + inset)));
    context.strokeStyle = colourOf(number);
    context.beginPath();
    for (let i = 0; i < 8; ++i)
      for (let k = 0; k < 3; ++k) {
        if (i >> k & 1) continue;
        const segment = visible(corners[i], corners[i | 1 << k]);
        if (!segment) continue;
        context.moveTo(...place(segment[0]));
        context.lineTo(...place(segment[1]));
      }
    context.stroke();
  });
}
