import { expect, test } from "vitest";

import { TRAIL_MAX, applyView, emptyFleet } from "../src/fleet";
import type { Fleet } from "../src/fleet";
import type { FleetView, Pose, TrailPoint, VehicleChange } from "../src/view";

const NOW = "2026-01-01T00:00:00.000Z";
const POINT: TrailPoint = { lat_deg: 39.9, lon_deg: -75.35, mode: "fused" };

function view(kind: FleetView["kind"], ...vehicles: VehicleChange[]): FleetView {
  return { kind, now: NOW, selected: "a", vehicles, gone: [], services: null };
}

function apply(fleet: Fleet, told: FleetView, monotonicMs = 0): void {
  applyView(fleet, told, { monotonicMs, serverMs: Date.parse(told.now) });
}

test("a change leaves what it does not name", () => {
  const fleet = emptyFleet();
  const status = { t: NOW, calibration: "none", outage_s: 0, late: 0, rejected: 0 } as const;
  apply(
    fleet,
    view("snapshot", { vehicle_id: "a", status: { ...status, last_rejection: null, slopes: [] } }),
  );
  apply(fleet, view("changes", { vehicle_id: "a", heard: NOW }));
  expect(fleet.vehicles.get("a")).toMatchObject({ heardMs: 0, status });
});

test("a trail grows, and begins anew when told", () => {
  const fleet = emptyFleet();
  apply(
    fleet,
    view("snapshot", { vehicle_id: "a", trail: [POINT, POINT], trail_restart: true }),
  );
  apply(fleet, view("changes", { vehicle_id: "a", trail: [POINT] }));
  expect(fleet.vehicles.get("a")?.trail).toHaveLength(3);
  const before = fleet.vehicles.get("a")?.trail;
  apply(fleet, view("changes", { vehicle_id: "a", trail: [POINT], trail_restart: true }));
  expect(fleet.vehicles.get("a")?.trail).toHaveLength(1);
  expect(fleet.vehicles.get("a")?.trail).not.toBe(before);
});

test("a trail stays bounded", () => {
  const fleet = emptyFleet();
  const many = Array(TRAIL_MAX).fill(POINT) as TrailPoint[];
  apply(fleet, view("snapshot", { vehicle_id: "a", trail: many, trail_restart: true }));
  apply(fleet, view("changes", { vehicle_id: "a", trail: [POINT] }));
  expect(fleet.vehicles.get("a")?.trail).toHaveLength(TRAIL_MAX);
});

test("a snapshot forgets vehicles that are gone", () => {
  const fleet = emptyFleet();
  apply(fleet, view("snapshot", { vehicle_id: "a" }));
  apply(fleet, view("snapshot", { vehicle_id: "b" }));
  expect([...fleet.vehicles.keys()]).toEqual(["b"]);
});

test("a pose is as old when it comes as the server says, by this page's clock from then on", () => {
  const fleet = emptyFleet();
  apply(fleet, view("snapshot", { vehicle_id: "a", heard: "2025-12-31T23:59:50.000Z" }), 60_000);
  expect(fleet.vehicles.get("a")?.heardMs).toBe(50_000);
  const stepped = { ...view("changes"), now: "2026-01-01T01:00:00.000Z" };
  apply(fleet, stepped, 61_000);
  expect(fleet.vehicles.get("a")?.heardMs).toBe(50_000);
});

test("a vehicle that is gone is dropped, and taken anew where it came back at once", () => {
  const fleet = emptyFleet();
  const trailed = { trail: [POINT], trail_restart: true };
  apply(
    fleet,
    view("snapshot", { vehicle_id: "a", ...trailed }, { vehicle_id: "b", heard: NOW }),
  );
  apply(fleet, { ...view("changes", { vehicle_id: "a", trail: [POINT] }), gone: ["a", "b"] });
  expect([...fleet.vehicles.keys()]).toEqual(["a"]);
  expect(fleet.vehicles.get("a")?.trail).toHaveLength(1);
});

test("of a vehicle that is no longer selected only its place is kept", () => {
  const fleet = emptyFleet();
  const horizon = { t: NOW, road_id: null, points: [] };
  const trailed = { trail: [POINT], trail_restart: true };
  const pose = { t: NOW, mode: "fused" } as Pose;
  apply(fleet, view("snapshot", { vehicle_id: "a", heard: NOW, pose, horizon, ...trailed }));
  expect(fleet.vehicles.get("a")?.horizon).toEqual(horizon);
  apply(fleet, { ...view("changes"), selected: "b" });
  expect(fleet.selected).toBe("b");
  expect(fleet.vehicles.get("a")).toEqual({ vehicle_id: "a", heardMs: 0, pose, trail: [] });
});
