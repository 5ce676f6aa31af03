// The trail from before the page's server was started, as history kept it.

import type { Vehicle } from "../fleet";
import type { TrailPoint } from "../view";
import { track } from "./history";
import { PastTrack } from "./track";

const HOUR_MS = 3_600_000;
const STEP_S = 2;

export class EarlierTrail {
  private key: string | null = null;
  private points: TrailPoint[] = [];
  private joined: TrailPoint[] = [];
  private joinedTo: readonly TrailPoint[] | null = null;

  constructor(private readonly onLoaded: () => void) {}

  /** The vehicle with what it drove in the hour before its trail begins. */
  before(vehicle: Vehicle): Vehicle {
    const { vehicle_id, trail, trail_began: began } = vehicle;
    if (began === undefined) {
      return vehicle;
    }
    const key = `${vehicle_id} ${began}`;
    if (key !== this.key) {
      void this.load(key, vehicle_id, Date.parse(began));
    }
    if (this.points.length === 0) {
      return vehicle;
    }
    if (this.joinedTo !== trail) {
      this.joined = [...this.points, ...trail];
      this.joinedTo = trail;
    }
    return { ...vehicle, trail: this.joined };
  }

  private async load(key: string, vehicleId: string, beganMs: number): Promise<void> {
    this.key = key;
    this.points = [];
    this.joinedTo = null;
    const span = { fromMs: beganMs - HOUR_MS, toMs: beganMs };
    // without a history there is no earlier trail, which is no harm: the past's own panel says why
    const points = await track(vehicleId, span, STEP_S).catch(() => []);
    if (key === this.key) {
      this.points = new PastTrack(points).trailTo(beganMs);
      this.onLoaded();
    }
  }
}
