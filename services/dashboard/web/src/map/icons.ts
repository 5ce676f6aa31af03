// The vehicle's marker, drawn here so that no sprite is fetched.

import type { Map as MapLibreMap } from "maplibre-gl";

import type { MapTheme } from "./theme";

const SIZE = 44;
const SCALE = 2;

/** An arrow where the heading is known, a dot where it is not; the selected vehicle is larger. */
export function addIcons(map: MapLibreMap, theme: MapTheme): void {
  const kinds = { selected: [theme.vehicle, 0.85], other: [theme.other, 0.65] } as const;
  for (const [kind, [color, size]] of Object.entries(kinds)) {
    addImage(map, `${kind}-arrow`, (pen) => arrow(pen, color, theme.halo, size));
    addImage(map, `${kind}-dot`, (pen) => dot(pen, color, theme.halo, size));
  }
}

function addImage(
  map: MapLibreMap,
  name: string,
  draw: (pen: CanvasRenderingContext2D) => void,
): void {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = SIZE * SCALE;
  const pen = canvas.getContext("2d");
  if (pen === null) {
    throw new Error("this browser draws no canvas");
  }
  pen.scale(SCALE, SCALE);
  pen.translate(SIZE / 2, SIZE / 2);
  draw(pen);
  const image = pen.getImageData(0, 0, canvas.width, canvas.height);
  if (map.hasImage(name)) {
    map.removeImage(name);
  }
  map.addImage(name, image, { pixelRatio: SCALE });
}

function arrow(pen: CanvasRenderingContext2D, color: string, edge: string, size: number): void {
  const path = new Path2D("M0-17 12 14Q0 6-12 14Z");
  paint(pen, path, color, edge, size);
}

function dot(pen: CanvasRenderingContext2D, color: string, edge: string, size: number): void {
  const path = new Path2D();
  path.arc(0, 0, 9, 0, 2 * Math.PI);
  paint(pen, path, color, edge, size);
}

function paint(
  pen: CanvasRenderingContext2D,
  path: Path2D,
  color: string,
  edge: string,
  size: number,
): void {
  pen.scale(size, size);
  pen.lineJoin = "round";
  pen.lineWidth = 5;
  pen.strokeStyle = edge;
  pen.stroke(path);
  pen.fillStyle = color;
  pen.fill(path);
}
