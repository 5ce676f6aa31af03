// Pure: puts snapshots and changes together into what is known now.

import type { FleetView, Service, TrailPoint, VehicleChange } from "./view";

/** As many as the server keeps (trail.py), so that a page left open does not grow. */
export const TRAIL_MAX = 2000;

export type Vehicle = Omit<VehicleChange, "trail" | "trail_restart"> & {
  trail: TrailPoint[];
  /** Grows whenever the trail changes, so that the map redraws it only then. */
  trailRevision: number;
};

export interface Fleet {
  vehicles: Map<string, Vehicle>;
  services: Service[];
  /** By route id; told once, whatever snapshots come. */
  routeNames: Map<string, string>;
}

export function emptyFleet(): Fleet {
  return { vehicles: new Map(), services: [], routeNames: new Map() };
}

/** Changes `fleet` in place. A snapshot replaces everything that was known. */
export function applyView(fleet: Fleet, view: FleetView): void {
  if (view.kind === "snapshot") {
    fleet.vehicles.clear();
    fleet.services = [];
  }
  if (view.services !== null) {
    fleet.services = view.services;
  }
  for (const change of view.vehicles) {
    fleet.vehicles.set(change.vehicle_id, changed(fleet.vehicles.get(change.vehicle_id), change));
  }
}

/** Remembers a route's name from its GeoJSON. */
export function nameRoute(fleet: Fleet, route: GeoJSON.FeatureCollection): void {
  for (const { properties } of route.features) {
    const { route_id: id, name } = (properties ?? {}) as { route_id?: string; name?: string };
    if (id !== undefined && name !== undefined) {
      fleet.routeNames.set(id, name);
    }
  }
}

function changed(known: Vehicle | undefined, change: VehicleChange): Vehicle {
  const { trail: added = [], trail_restart: restarts = false, ...sections } = change;
  const before = known ?? { vehicle_id: change.vehicle_id, trail: [], trailRevision: 0 };
  if (!restarts && added.length === 0) {
    return { ...before, ...sections };
  }
  const trail = restarts ? added : [...before.trail, ...added].slice(-TRAIL_MAX);
  return { ...before, ...sections, trail, trailRevision: before.trailRevision + 1 };
}
