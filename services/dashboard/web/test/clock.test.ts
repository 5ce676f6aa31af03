import { expect, test } from "vitest";

import { ServerClock, ageS, isRecording, vehicleNowMs } from "../src/clock";
import type { Now } from "../src/clock";
import type { Vehicle } from "../src/fleet";
import type { Pose, Service } from "../src/view";

const SERVER = "2026-01-01T12:00:00.000Z";
const SERVER_MS = Date.parse(SERVER);
const UNHEARD: Vehicle = { vehicle_id: "a", trail: [] };

function vehicle(t: string, heardMs: number): Vehicle {
  return { ...UNHEARD, heardMs, pose: { t, mode: "fused" } as Pose };
}

function at(monotonicMs: number): Now {
  return { monotonicMs, serverMs: SERVER_MS };
}

test("the server's clock goes on with the monotonic one", () => {
  let monotonicMs = 1000;
  const clock = new ServerClock(() => monotonicMs);
  expect(clock.set(SERVER)).toEqual(at(1000));
  monotonicMs += 2500;
  expect(clock.now()).toEqual({ monotonicMs: 3500, serverMs: SERVER_MS + 2500 });
});

test("a pose ages by the page's own clock, whatever the server's says", () => {
  const seen = vehicle("2026-01-01T11:59:58.000Z", 5000);
  expect(ageS(seen, at(8000))).toBe(3);
  expect(ageS(seen, { monotonicMs: 8000, serverMs: SERVER_MS + 3_600_000 })).toBe(3);
});

test("a vehicle's present is its pose's instant, carried on", () => {
  const old = vehicle("2018-11-12T14:00:00.000Z", 5000);
  expect(vehicleNowMs(old, at(6000))).toBe(Date.parse("2018-11-12T14:00:01.000Z"));
});

test("without a pose there is no age, and the present is the server's", () => {
  expect(ageS(UNHEARD, at(0))).toBeNull();
  expect(vehicleNowMs(UNHEARD, at(0))).toBe(SERVER_MS);
});

test("a recording is what a service that is up calls one", () => {
  const played = { service: "wayline-play", up: true, recorded: true } as Service;
  const live = { service: "fusion", up: true, recorded: false } as Service;
  expect(isRecording({ ...UNHEARD, services: [live, played] })).toBe(true);
  expect(isRecording({ ...UNHEARD, services: [live, { ...played, up: false }] })).toBe(false);
  expect(isRecording(vehicle("2018-11-12T14:00:00.000Z", 0))).toBe(false);
});
