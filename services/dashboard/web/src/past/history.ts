// What history answers, asked of the page's own host.

import { savedToken, tokenHeaders } from "../access";
import type { PastPoint } from "./track";

export interface PastStop {
  started: string;
  dwell_s: number;
  lat_deg: number;
  lon_deg: number;
}

export interface Trip {
  trip_key: string;
  started: string;
  ended: string;
  under_way: boolean;
  seconds: number;
  distance_m: number;
  distance_std_m: number;
  climb_m: number | null;
  stops: PastStop[];
}

export interface PastEvent {
  t: string;
  until: string | null;
  kind: string;
  name: string;
  count: number | null;
  detail: string | null;
}

/** From an instant on and before another, Unix milliseconds. */
export interface Span {
  fromMs: number;
  toMs: number;
}

export type Form = "gpx" | "csv" | "geojson";

export async function trips(vehicleId: string, span: Span): Promise<Trip[]> {
  return ((await json(vehicleId, "trips", span)) as { trips: Trip[] }).trips;
}

export async function events(vehicleId: string, span: Span): Promise<PastEvent[]> {
  return ((await json(vehicleId, "events", span)) as { events: PastEvent[] }).events;
}

export async function track(
  vehicleId: string,
  span: Span,
  stepS: number,
): Promise<PastPoint[]> {
  const more = { step_s: `${stepS}` };
  return ((await json(vehicleId, "track", span, more)) as { points: PastPoint[] }).points;
}

/** Saves a track as a file; a plain link could not carry the token. */
export async function save(vehicleId: string, span: Span, form: Form): Promise<void> {
  const answer = await asked(vehicleId, `track.${form}`, span);
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await answer.blob());
  link.download = `${vehicleId}-${new Date(span.fromMs).toISOString().slice(0, 16)}.${form}`;
  link.click();
  URL.revokeObjectURL(link.href);
}

async function json(
  vehicleId: string,
  what: string,
  span: Span,
  more: Record<string, string> = {},
): Promise<unknown> {
  return (await asked(vehicleId, what, span, more)).json();
}

async function asked(
  vehicleId: string,
  what: string,
  { fromMs, toMs }: Span,
  more: Record<string, string> = {},
): Promise<Response> {
  const [from, to] = [new Date(fromMs).toISOString(), new Date(toMs).toISOString()];
  const path = `/v1/vehicles/${encodeURIComponent(vehicleId)}/${what}`;
  const answer = await fetch(`${path}?${new URLSearchParams({ from, to, ...more })}`, {
    headers: tokenHeaders(savedToken()),
  });
  if (!answer.ok) {
    const { detail } = (await answer.json()) as { detail?: string };
    throw new Error(detail ?? `${answer.status}`);
  }
  return answer;
}
