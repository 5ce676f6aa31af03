import { expect, test } from "vitest";

import { TRAIL_MAX, applyView, emptyFleet } from "../src/fleet";
import type { FleetView, TrailPoint, VehicleChange } from "../src/view";

const NOW = "2026-01-01T00:00:00.000Z";
const POINT: TrailPoint = { lat_deg: 39.9, lon_deg: -75.35, mode: "fused" };

function view(kind: FleetView["kind"], ...vehicles: VehicleChange[]): FleetView {
  return { kind, now: NOW, vehicles, services: null };
}

test("a change leaves what it does not name", () => {
  const fleet = emptyFleet();
  const status = { t: NOW, calibration: "none", outage_s: 0, late: 0, rejected: 0 } as const;
  applyView(
    fleet,
    view("snapshot", { vehicle_id: "a", status: { ...status, last_rejection: null } }),
  );
  applyView(fleet, view("changes", { vehicle_id: "a", heard: NOW }));
  expect(fleet.vehicles.get("a")).toMatchObject({ heard: NOW, status });
});

test("a trail grows, and begins anew when told", () => {
  const fleet = emptyFleet();
  applyView(
    fleet,
    view("snapshot", { vehicle_id: "a", trail: [POINT, POINT], trail_restart: true }),
  );
  applyView(fleet, view("changes", { vehicle_id: "a", trail: [POINT] }));
  expect(fleet.vehicles.get("a")?.trail).toHaveLength(3);
  const before = fleet.vehicles.get("a")?.trailRevision;
  applyView(fleet, view("changes", { vehicle_id: "a", trail: [POINT], trail_restart: true }));
  expect(fleet.vehicles.get("a")?.trail).toHaveLength(1);
  expect(fleet.vehicles.get("a")?.trailRevision).not.toBe(before);
});

test("a trail stays bounded", () => {
  const fleet = emptyFleet();
  const many = Array(TRAIL_MAX).fill(POINT) as TrailPoint[];
  applyView(fleet, view("snapshot", { vehicle_id: "a", trail: many, trail_restart: true }));
  applyView(fleet, view("changes", { vehicle_id: "a", trail: [POINT] }));
  expect(fleet.vehicles.get("a")?.trail).toHaveLength(TRAIL_MAX);
});

test("a snapshot forgets vehicles that are gone", () => {
  const fleet = emptyFleet();
  applyView(fleet, view("snapshot", { vehicle_id: "a" }));
  applyView(fleet, view("snapshot", { vehicle_id: "b" }));
  expect([...fleet.vehicles.keys()]).toEqual(["b"]);
});
