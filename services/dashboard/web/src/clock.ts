// Pure: what time it is for the server and for a vehicle, whatever this device's clock says.

import type { Vehicle } from "./fleet";

/** A vehicle whose own time is further off than this is being played from a recording. */
const RECORDING_MS = 3_600_000;

/** The server's clock, carried on by a monotonic one. */
export class ServerClock {
  private offsetMs = 0;

  constructor(private readonly monotonicMs: () => number) {}

  /** Takes the server's time from a message that has just arrived. */
  set(now: string): void {
    this.offsetMs = Date.parse(now) - this.monotonicMs();
  }

  nowMs(): number {
    return this.monotonicMs() + this.offsetMs;
  }
}

export function isRecording(vehicle: Vehicle): boolean {
  const { pose, heard } = vehicle;
  return (
    pose !== undefined &&
    heard !== undefined &&
    Math.abs(Date.parse(heard) - Date.parse(pose.t)) > RECORDING_MS
  );
}

/** Age of the pose in seconds, or null without one. In a recording, since it was heard. */
export function ageS(vehicle: Vehicle, nowMs: number): number | null {
  const { pose, heard } = vehicle;
  if (pose === undefined) {
    return null;
  }
  const from = isRecording(vehicle) && heard !== undefined ? heard : pose.t;
  return Math.max(0, (nowMs - Date.parse(from)) / 1000);
}

/** The vehicle's present time, which its arrivals count from. */
export function vehicleNowMs(vehicle: Vehicle, nowMs: number): number {
  const { pose, heard } = vehicle;
  if (pose !== undefined && heard !== undefined && isRecording(vehicle)) {
    return Date.parse(pose.t) + (nowMs - Date.parse(heard));
  }
  return nowMs;
}
