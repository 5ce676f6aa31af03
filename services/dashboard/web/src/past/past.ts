// The past of one vehicle: a day's trips and events, a stretch of it that is replayed.

import type { Fleet } from "../fleet";
import type { Pose, TrailPoint } from "../view";
import { events, save, track, trips } from "./history";
import type { Form, PastEvent, Span, Trip } from "./history";
import { PastTrack } from "./track";

export const HOUR_MS = 3_600_000;
const DAY_MS = 24 * HOUR_MS;
const FRAME_MS = 100;
const STEP_S = 1;

export class Past {
  /** Whose past is looked at; null: the page shows the present. */
  vehicleId: string | null = null;
  /** The day's first instant by the reader's clock. */
  dayMs = 0;
  trips: Trip[] = [];
  events: PastEvent[] = [];
  /** The stretch that is replayed. */
  span: Span = { fromMs: 0, toMs: 0 };
  atMs = 0;
  isPlaying = false;
  speed = 10;
  problem: string | null = null;
  isLoading = false;

  private track = new PastTrack([]);
  private trail: TrailPoint[] = [];
  private trailTo = -1;
  private timer: number | undefined;
  /** Answers that come after others were asked for are thrown away. */
  private asked = 0;

  constructor(private readonly onChange: () => void) {}

  /** Looks at the day of an instant, with the hour before it. */
  open(vehicleId: string, nowMs: number): void {
    this.vehicleId = vehicleId;
    void this.load(startOfDay(nowMs), { fromMs: nowMs - HOUR_MS, toMs: nowMs });
  }

  /** Back to the present. */
  close(): void {
    this.pause();
    this.asked += 1;
    this.vehicleId = null;
    this.onChange();
  }

  /** Another day, from its first trip on. */
  async chooseDay(dayMs: number): Promise<void> {
    await this.load(dayMs, { fromMs: dayMs, toMs: dayMs + HOUR_MS });
    const [first] = this.trips;
    if (first !== undefined) {
      this.chooseTrip(first);
    }
  }

  chooseHour(hour: number): void {
    const fromMs = this.dayMs + hour * HOUR_MS;
    void this.replay({ fromMs, toMs: fromMs + HOUR_MS });
  }

  chooseTrip(trip: Trip): void {
    void this.replay({ fromMs: Date.parse(trip.started), toMs: Date.parse(trip.ended) + 1_000 });
  }

  /** Goes to what happened, in the hour around it where it is not in the stretch. */
  async chooseEvent(event: PastEvent): Promise<void> {
    const ms = Date.parse(event.t);
    if (ms < this.span.fromMs || ms >= this.span.toMs) {
      await this.replay({ fromMs: ms - HOUR_MS / 2, toMs: ms + HOUR_MS / 2 });
    }
    this.seek(ms);
  }

  seek(ms: number): void {
    this.atMs = Math.min(Math.max(ms, this.span.fromMs), this.span.toMs);
    this.onChange();
  }

  toggle(): void {
    if (this.isPlaying) {
      this.pause();
    } else {
      if (this.atMs >= this.span.toMs) {
        this.atMs = this.span.fromMs;
      }
      this.isPlaying = true;
      let lastMs = performance.now();
      this.timer = window.setInterval(() => {
        const nowMs = performance.now();
        this.advance((nowMs - lastMs) * this.speed);
        lastMs = nowMs;
      }, FRAME_MS);
    }
    this.onChange();
  }

  setSpeed(speed: number): void {
    this.speed = speed;
    this.onChange();
  }

  async save(form: Form): Promise<void> {
    const { vehicleId } = this;
    if (vehicleId !== null) {
      await this.trying(() => save(vehicleId, this.span, form));
    }
  }

  /** The fleet with the vehicle where it was then; the fleet itself in the present. */
  shown(fleet: Fleet): Fleet {
    if (this.vehicleId === null) {
      return fleet;
    }
    const { pose } = this;
    if (this.trailTo !== this.atMs) {
      this.trail = this.track.trailTo(this.atMs);
      this.trailTo = this.atMs;
    }
    const then = { vehicle_id: this.vehicleId, trail: this.trail, ...(pose && { pose }) };
    return { ...fleet, vehicles: new Map([[this.vehicleId, then]]) };
  }

  /** Where the vehicle was then. */
  get pose(): Pose | null {
    return this.track.poseAt(this.atMs);
  }

  get isEmpty(): boolean {
    return this.track.isEmpty;
  }

  private advance(byMs: number): void {
    if (this.atMs + byMs >= this.span.toMs) {
      this.pause();
    }
    this.seek(this.atMs + byMs);
  }

  private pause(): void {
    window.clearInterval(this.timer);
    this.isPlaying = false;
  }

  private async load(dayMs: number, span: Span): Promise<void> {
    const { vehicleId } = this;
    if (vehicleId === null) {
      return;
    }
    this.dayMs = dayMs;
    this.trips = [];
    this.events = [];
    const day = { fromMs: dayMs, toMs: dayMs + DAY_MS };
    await this.trying(async (isCurrent) => {
      const found = await Promise.all([trips(vehicleId, day), events(vehicleId, day)]);
      if (isCurrent()) {
        [this.trips, this.events] = found;
      }
    });
    if (this.problem === null) {
      await this.replay(span);
    }
  }

  private async replay(span: Span): Promise<void> {
    const { vehicleId } = this;
    if (vehicleId === null) {
      return;
    }
    this.pause();
    await this.trying(async (isCurrent) => {
      const points = await track(vehicleId, span, STEP_S);
      if (isCurrent()) {
        // the slider spans what there is, of an hour that is half empty too
        const [first, last] = [points[0], points.at(-1)].map((each) => each && Date.parse(each.t));
        this.track = new PastTrack(points);
        this.span = { fromMs: first ?? span.fromMs, toMs: last ?? span.toMs };
        this.atMs = this.span.fromMs;
        this.trailTo = -1;
      }
    });
  }

  /** Says what went wrong, unless something else has been asked for meanwhile. */
  private async trying(ask: (isCurrent: () => boolean) => Promise<void>): Promise<void> {
    this.asked += 1;
    const number = this.asked;
    const isCurrent = (): boolean => number === this.asked;
    this.problem = null;
    this.isLoading = true;
    this.onChange();
    try {
      await ask(isCurrent);
    } catch (error) {
      if (isCurrent()) {
        this.problem = error instanceof Error ? error.message : String(error);
      }
    }
    if (isCurrent()) {
      this.isLoading = false;
      this.onChange();
    }
  }
}

export function startOfDay(ms: number): number {
  return new Date(ms).setHours(0, 0, 0, 0);
}
