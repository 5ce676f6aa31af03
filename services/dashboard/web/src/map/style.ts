// Pure: the map's style. It names no tiles, glyphs or sprites, so nothing comes from elsewhere.

import type { LayerSpecification, SourceSpecification, StyleSpecification } from "maplibre-gl";

import type { MapTheme } from "./theme";

/** One GeoJSON source a kind of thing, so that each is redrawn only when it changes. */
export const SOURCES = ["grid", "routes", "stops", "trail", "ellipse", "fix", "vehicles"] as const;
export type SourceName = (typeof SOURCES)[number];

const FONT = ["system-ui", "Noto Sans", "DejaVu Sans", "sans-serif"];
const EMPTY: SourceSpecification = {
  type: "geojson",
  data: { type: "FeatureCollection", features: [] },
};

export function mapStyle(theme: MapTheme): StyleSpecification {
  return {
    version: 8,
    sources: Object.fromEntries(SOURCES.map((name) => [name, EMPTY])),
    layers: [
      { id: "background", type: "background", paint: { "background-color": theme.background } },
      ...gridLayers(theme),
      ...routeLayers(theme),
      ...trackLayers(theme),
      ...stopLayers(theme),
      ...vehicleLayers(theme),
    ],
    transition: { duration: 0, delay: 0 },
  };
}

function gridLayers(theme: MapTheme): LayerSpecification[] {
  return [
    { id: "grid", type: "line", source: "grid", paint: { "line-color": theme.grid } },
    {
      id: "grid-labels",
      type: "symbol",
      source: "grid",
      layout: {
        "symbol-placement": "line",
        "symbol-spacing": 600,
        "text-field": ["get", "label"],
        "text-font": FONT,
        "text-size": 10,
        "text-offset": [0, -0.8],
        "text-optional": true,
      },
      paint: { "text-color": theme.gridText },
    },
  ];
}

function routeLayers(theme: MapTheme): LayerSpecification[] {
  const layout = { "line-cap": "round", "line-join": "round" } as const;
  return [
    {
      id: "route-casing",
      type: "line",
      source: "routes",
      layout,
      paint: { "line-color": theme.routeCasing, "line-width": width(5, 15) },
    },
    {
      id: "route",
      type: "line",
      source: "routes",
      layout,
      paint: { "line-color": theme.route, "line-width": width(3, 11) },
    },
  ];
}

function width(far: number, near: number): ["interpolate", ["linear"], ["zoom"], ...number[]] {
  return ["interpolate", ["linear"], ["zoom"], 12, far, 18, near];
}

function trackLayers(theme: MapTheme): LayerSpecification[] {
  const layout = { "line-cap": "butt", "line-join": "round" } as const;
  return [
    {
      id: "trail",
      type: "line",
      source: "trail",
      filter: ["!", ["get", "reckoned"]],
      layout,
      paint: { "line-color": theme.trail, "line-width": width(2, 4) },
    },
    {
      id: "trail-reckoned",
      type: "line",
      source: "trail",
      filter: ["get", "reckoned"],
      layout,
      paint: {
        "line-color": theme.reckoned,
        "line-width": width(2, 4),
        "line-dasharray": [2, 1],
      },
    },
    {
      id: "ellipse",
      type: "fill",
      source: "ellipse",
      paint: { "fill-color": theme.vehicle, "fill-opacity": 0.16 },
    },
    {
      id: "ellipse-outline",
      type: "line",
      source: "ellipse",
      paint: { "line-color": theme.vehicle, "line-width": 1.2, "line-opacity": 0.8 },
    },
  ];
}

function stopLayers(theme: MapTheme): LayerSpecification[] {
  return [
    {
      id: "stops",
      type: "circle",
      source: "stops",
      paint: {
        "circle-radius": 5,
        "circle-color": theme.halo,
        "circle-stroke-color": theme.stop,
        "circle-stroke-width": 2,
      },
    },
    {
      id: "stop-names",
      type: "symbol",
      source: "stops",
      layout: {
        "text-field": ["get", "name"],
        "text-font": FONT,
        "text-size": 12,
        "text-variable-anchor": ["left", "right", "bottom", "top"],
        "text-radial-offset": 0.9,
        "text-justify": "auto",
        "text-optional": true,
      },
      paint: { "text-color": theme.text, "text-halo-color": theme.halo, "text-halo-width": 1.6 },
    },
  ];
}

function vehicleLayers(theme: MapTheme): LayerSpecification[] {
  return [
    {
      id: "vehicles",
      type: "symbol",
      source: "vehicles",
      layout: {
        "icon-image": ["get", "icon"],
        "icon-rotate": ["get", "heading_deg"],
        "icon-rotation-alignment": "map",
        "icon-allow-overlap": true,
        "icon-ignore-placement": true,
        "symbol-sort-key": ["get", "rank"],
      },
    },
    {
      id: "fix",
      type: "circle",
      source: "fix",
      paint: {
        "circle-radius": 4.5,
        "circle-color": "rgba(0, 0, 0, 0)",
        "circle-stroke-color": theme.fix,
        "circle-stroke-width": 2,
      },
    },
    {
      id: "vehicle-names",
      type: "symbol",
      source: "vehicles",
      filter: ["get", "named"],
      layout: {
        "text-field": ["get", "vehicle_id"],
        "text-font": FONT,
        "text-size": 12,
        "text-anchor": "top",
        "text-offset": [0, 1.4],
        "text-optional": true,
      },
      paint: { "text-color": theme.text, "text-halo-color": theme.halo, "text-halo-width": 1.6 },
    },
  ];
}
