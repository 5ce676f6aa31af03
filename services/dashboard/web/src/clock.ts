// Pure: how old things are and what time it is, whatever this device's and the server's clock say.

import type { Vehicle } from "./fleet";

/** One instant by two clocks. */
export interface Now {
  /** This page's own, which nobody sets: ages are measured by it. */
  monotonicMs: number;
  /** The server's Unix time. */
  serverMs: number;
}

/** The server's clock, carried on by a monotonic one. */
export class ServerClock {
  private offsetMs = 0;

  constructor(private readonly monotonicMs: () => number) {}

  /** Takes the server's time from a message that has just arrived; returns that instant. */
  set(now: string): Now {
    const monotonicMs = this.monotonicMs();
    this.offsetMs = Date.parse(now) - monotonicMs;
    return { monotonicMs, serverMs: Date.parse(now) };
  }

  now(): Now {
    const monotonicMs = this.monotonicMs();
    return { monotonicMs, serverMs: monotonicMs + this.offsetMs };
  }
}

/** Age of the pose in seconds, or null without one. */
export function ageS({ heardMs }: Vehicle, now: Now): number | null {
  return heardMs === undefined ? null : Math.max(0, (now.monotonicMs - heardMs) / 1000);
}

/** The vehicle's present time, which its arrivals count from: that of its pose, carried on. */
export function vehicleNowMs({ pose, heardMs }: Vehicle, now: Now): number {
  return pose === undefined || heardMs === undefined
    ? now.serverMs
    : Date.parse(pose.t) + (now.monotonicMs - heardMs);
}

/** Whether one of its services says that it plays a recording. */
export function isRecording({ services = [] }: Vehicle): boolean {
  return services.some((service) => service.up && service.recorded);
}
