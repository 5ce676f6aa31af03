// Pure: puts snapshots and changes together into what is known now.

import type { Now } from "./clock";
import type { FleetView, Service, TrailPoint, VehicleChange } from "./view";

/** As many as the server keeps (trail.py), so that a page left open does not grow. */
export const TRAIL_MAX = 2000;

export type Vehicle = Omit<VehicleChange, "heard" | "trail" | "trail_restart"> & {
  /** When its pose was new, by this page's monotonic clock: no clock that is set changes ages. */
  heardMs?: number;
  /** Another array whenever the trail changes, so that the map redraws it only then. */
  trail: TrailPoint[];
};

export interface Fleet {
  vehicles: Map<string, Vehicle>;
  /** The vehicle that all is known of; of the others only the pose is. */
  selected: string | null;
  services: Service[];
  /** By route id; told once, whatever snapshots come. */
  routeNames: Map<string, string>;
}

export function emptyFleet(): Fleet {
  return { vehicles: new Map(), selected: null, services: [], routeNames: new Map() };
}

/** Changes `fleet` in place by a view that came `now`. A snapshot replaces what was known. */
export function applyView(fleet: Fleet, view: FleetView, now: Now): void {
  if (view.kind === "snapshot") {
    fleet.vehicles.clear();
    fleet.services = [];
  }
  if (view.services !== null) {
    fleet.services = view.services;
  }
  if (view.selected !== fleet.selected) {
    forgetDetails(fleet);
    fleet.selected = view.selected;
  }
  for (const vehicleId of view.gone) {
    fleet.vehicles.delete(vehicleId);
  }
  for (const { heard, ...change } of view.vehicles) {
    const vehicle = changed(fleet.vehicles.get(change.vehicle_id), change);
    if (heard !== undefined) {
      vehicle.heardMs = now.monotonicMs - (now.serverMs - Date.parse(heard));
    }
    fleet.vehicles.set(change.vehicle_id, vehicle);
  }
}

/** What is no longer told is dropped, or it would be shown as if it were new. */
function forgetDetails(fleet: Fleet): void {
  const vehicle = fleet.vehicles.get(fleet.selected ?? "");
  if (vehicle !== undefined) {
    const { vehicle_id, pose, heardMs } = vehicle;
    fleet.vehicles.set(vehicle_id, {
      vehicle_id,
      ...(pose && { pose }),
      ...(heardMs !== undefined && { heardMs }),
      trail: [],
    });
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

function changed(known: Vehicle | undefined, change: Omit<VehicleChange, "heard">): Vehicle {
  const { trail: added = [], trail_restart: restarts = false, ...sections } = change;
  const before = known ?? { vehicle_id: change.vehicle_id, trail: [] };
  if (!restarts && added.length === 0) {
    return { ...before, ...sections };
  }
  const trail = restarts ? added : [...before.trail, ...added].slice(-TRAIL_MAX);
  return { ...before, ...sections, trail };
}
