// Pure: how a vehicle or a service is doing, in one word that colours follow.

import { ageS } from "./clock";
import type { Now } from "./clock";
import type { Vehicle } from "./fleet";
import type { Missing, Service } from "./view";

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

/** Since when the page's own server hears no router: then nobody's services are known. */
export function goneBus(services: Iterable<Service>): Missing | null {
  for (const { service, missing } of services) {
    const router = missing.find(({ subject }) => subject === "router");
    if (service === "dashboard" && router !== undefined) {
      return router;
    }
  }
  return null;
}

/** `isKnown`: the bus tells of services; without it they may be as well as ever. */
export function serviceTone(service: Service, isKnown: boolean): Tone {
  if (!isKnown) {
    return "off";
  }
  if (!service.up) {
    return "bad";
  }
  const isTroubled = service.missing.length > 0 || service.dropped_rate_hz > 0;
  return isTroubled ? "warn" : "good";
}

/** All services in a few words. */
export function servicesInWords(services: Service[], isKnown: boolean): string {
  if (!isKnown) {
    return "not known";
  }
  const down = services.filter((service) => !service.up).length;
  const lacking = services.filter((service) => service.up && service.missing.length > 0).length;
  const parts = [
    ...(down > 0 ? [`${down} down`] : []),
    ...(lacking > 0 ? [`${lacking} not ready`] : []),
  ];
  return parts.length === 0 ? "all up" : parts.join(", ");
}
