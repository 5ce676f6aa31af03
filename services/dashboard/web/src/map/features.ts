// Pure: what is known of the vehicles as GeoJSON for the map's sources.

import type { Vehicle } from "../fleet";
import { SIGMAS_95, ellipseOutline, gridLines, trailLines } from "../geometry";
import type { Area, LonLat } from "../geometry";
import type { TrailPoint } from "../view";

type Features = GeoJSON.FeatureCollection;

function collection(features: GeoJSON.Feature[]): Features {
  return { type: "FeatureCollection", features };
}

function feature(
  geometry: GeoJSON.Geometry,
  properties: GeoJSON.GeoJsonProperties = {},
): GeoJSON.Feature {
  return { type: "Feature", geometry, properties };
}

export function position(vehicle: Vehicle | undefined): LonLat | null {
  const pose = vehicle?.pose;
  return pose?.lat_deg == null || pose.lon_deg == null ? null : [pose.lon_deg, pose.lat_deg];
}

export function vehicleFeatures(vehicles: Iterable<Vehicle>, selected: string | null): Features {
  const all = [...vehicles];
  return collection(
    all.flatMap((vehicle) => {
      const coordinates = position(vehicle);
      if (coordinates === null) {
        return [];
      }
      const isSelected = vehicle.vehicle_id === selected;
      const heading = vehicle.pose?.heading_deg ?? null;
      const icon = `${isSelected ? "selected" : "other"}-${heading === null ? "dot" : "arrow"}`;
      return feature(
        { type: "Point", coordinates },
        {
          vehicle_id: vehicle.vehicle_id,
          icon,
          heading_deg: heading ?? 0,
          rank: isSelected ? 1 : 0,
          named: all.length > 1,
        },
      );
    }),
  );
}

/** The region that holds the vehicle with a probability of 95 %. */
export function ellipseFeatures(vehicle: Vehicle | undefined): Features {
  const center = position(vehicle);
  const ellipse = vehicle?.pose?.ellipse;
  if (center === null || ellipse == null) {
    return collection([]);
  }
  const outline = ellipseOutline(center, ellipse, SIGMAS_95);
  return collection([feature({ type: "Polygon", coordinates: [outline] })]);
}

export function fixFeatures(vehicle: Vehicle | undefined): Features {
  const fix = vehicle?.fix;
  if (fix === undefined || !fix.valid || fix.lat_deg === null || fix.lon_deg === null) {
    return collection([]);
  }
  return collection([feature({ type: "Point", coordinates: [fix.lon_deg, fix.lat_deg] })]);
}

export function trailFeatures(trail: readonly TrailPoint[]): Features {
  return collection(
    trailLines(trail).map(({ line, reckoned }) =>
      feature({ type: "LineString", coordinates: line }, { reckoned }),
    ),
  );
}

export function gridFeatures(area: Area, wanted: number): Features {
  return collection(
    gridLines(area, wanted).map(({ line, label }) =>
      feature({ type: "LineString", coordinates: line }, { label }),
    ),
  );
}

/** The features of one geometry type of all routes. */
export function routeFeatures(routes: readonly Features[], type: "LineString" | "Point"): Features {
  return collection(
    routes.flatMap((route) => route.features.filter((found) => found.geometry.type === type)),
  );
}
