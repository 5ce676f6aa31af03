// Pure: how a vehicle or a service is doing, in one word that colours follow.

import { ageS } from "./clock";
import type { Now } from "./clock";
import type { Vehicle } from "./fleet";
import type { Service } from "./view";

/** Poses come at 10 Hz, without CAN at 1 Hz: three of those are missing (SPEC, stale rule). */
const STALE_S = 3;

export type Tone = "good" | "info" | "warn" | "bad" | "off";

export function isStale(vehicle: Vehicle, now: Now): boolean {
  const age = ageS(vehicle, now);
  return age === null || age > STALE_S;
}

export function vehicleTone(vehicle: Vehicle, now: Now): Tone {
  if (isStale(vehicle, now)) {
    return "off";
  }
  switch (vehicle.pose?.mode) {
    case "fused":
      return "good";
    case "gps":
      return "info";
    case "dead_reckoning":
      return "warn";
    case "lost":
      return "bad";
    default:
      return "off";
  }
}

export function serviceTone(service: Service): Tone {
  if (!service.up) {
    return "bad";
  }
  return service.dropped > 0 ? "warn" : "good";
}
