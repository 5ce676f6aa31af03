// The past of the selected vehicle: its day's trips and events, and a slider through a stretch.

import { html } from "lit-html";
import type { TemplateResult } from "lit-html";

import type { Form, PastEvent, Trip } from "../past/history";
import { HOUR_MS, startOfDay } from "../past/past";
import type { Past } from "../past/past";
import type { Pose, PoseMode } from "../view";
import {
  MODE_NAMES,
  UNKNOWN,
  clockRange,
  clockTime,
  compassPoint,
  dateAndTime,
  duration,
  heading,
  length,
  speedKmh,
  travelled,
} from "../words";

const SPEEDS = [1, 5, 10, 30, 60, 300];
const HOURS = Array.from({ length: 24 }, (_, hour) => hour);
const FORMS: readonly Form[] = ["gpx", "csv", "geojson"];
const KINDS: Record<string, string> = {
  mode: "Mode",
  outage: "No fixes",
  rejected: "Refused",
  off_route: "Off the route",
  stop: "Stop",
  service_up: "Service back",
  service_down: "Service gone",
  gap: "Not kept",
};

export function pastPanel(vehicleId: string, past: Past, nowMs: number): TemplateResult {
  if (past.vehicleId !== vehicleId) {
    return html`
      <section id="past" aria-labelledby="past-title">
        <div class="title-row">
          <h2 id="past-title">Past</h2>
          <button id="past-open" type="button" @click=${() => past.open(vehicleId, nowMs)}>
            Look back
          </button>
        </div>
      </section>
    `;
  }
  return html`
    <section id="past" aria-labelledby="past-title" aria-busy=${past.isLoading ? "true" : "false"}>
      <div class="title-row">
        <h2 id="past-title">${vehicleId}, past</h2>
        <button id="past-close" type="button" @click=${() => past.close()}>Back to live</button>
      </div>
      ${player(past)} ${choice(past, nowMs)} ${tripList(past)} ${eventList(past)} ${files(past)}
    </section>
  `;
}

function player(past: Past): TemplateResult {
  const { span, atMs } = past;
  return html`
    <div class="player">
      <output id="past-at">${said(past)}</output>
      <p id="past-pose" class="past-more">${poseText(past.pose)}</p>
      <input
        id="past-slider"
        type="range"
        aria-label="Instant"
        aria-valuetext=${dateAndTime(atMs)}
        min=${span.fromMs}
        max=${span.toMs}
        step="1000"
        .value=${`${atMs}`}
        @input=${(event: Event) => past.seek(valueOf(event))}
      />
      <div class="player-row">
        <button id="past-play" type="button" @click=${() => past.toggle()}>
          ${past.isPlaying ? "Pause" : "Play"}
        </button>
        <label>
          Speed
          <select id="past-speed" @change=${(event: Event) => past.setSpeed(valueOf(event))}>
            ${SPEEDS.map(
              (speed) =>
                html`<option value=${speed} ?selected=${speed === past.speed}>${speed}×</option>`,
            )}
          </select>
        </label>
        <span class="player-span">${clockRange(span.fromMs, span.toMs)}</span>
      </div>
    </div>
  `;
}

function said(past: Past): string {
  if (past.problem !== null) {
    return past.problem;
  }
  if (past.isLoading) {
    return "Loading…";
  }
  return past.isEmpty ? "Nothing is kept of this time." : dateAndTime(past.atMs);
}

function poseText(pose: Pose | null): string {
  if (pose === null) {
    return UNKNOWN;
  }
  const { mode, speed_mps, heading_deg, alt_m } = pose;
  const parts = [
    MODE_NAMES[mode],
    `${speedKmh(speed_mps)} km/h`,
    `${heading(heading_deg)} ${compassPoint(heading_deg)}`,
    `altitude ${length(alt_m)}`,
  ];
  return parts.filter((part) => !part.includes(UNKNOWN)).join(" · ");
}

function choice(past: Past, nowMs: number): TemplateResult {
  const hour = Math.floor((past.span.fromMs - past.dayMs) / HOUR_MS);
  return html`
    <div class="player-row">
      <label>
        Day
        <input
          id="past-day"
          type="date"
          max=${isoDay(nowMs)}
          .value=${isoDay(past.dayMs)}
          @change=${(event: Event) => chooseDay(past, event)}
        />
      </label>
      <label>
        Hour
        <select
          id="past-hour"
          .value=${`${hour}`}
          @change=${(event: Event) => past.chooseHour(valueOf(event))}
        >
          ${HOURS.map(
            (each) =>
              html`<option value=${each} ?selected=${each === hour}>
                ${clockTime(past.dayMs + each * HOUR_MS)}
              </option>`,
          )}
        </select>
      </label>
    </div>
  `;
}

function tripList(past: Past): TemplateResult {
  if (past.trips.length === 0) {
    return html`<p class="empty">No trip is known of this day.</p>`;
  }
  return html`
    <h3>Trips</h3>
    <ul class="past-list" id="past-trips">
      ${past.trips.map(
        (trip) => html`<li>
          <button type="button" @click=${() => past.chooseTrip(trip)}>${tripText(trip)}</button>
        </li>`,
      )}
    </ul>
  `;
}

function tripText(trip: Trip): TemplateResult {
  const stops = trip.stops.length;
  const more = [
    travelled(trip.distance_m, trip.distance_std_m),
    duration(trip.seconds),
    ...(stops === 0 ? [] : [stops === 1 ? "1 stop" : `${stops} stops`]),
    ...(trip.under_way ? ["under way"] : []),
  ];
  return html`
    <span>${clockRange(Date.parse(trip.started), Date.parse(trip.ended))}</span>
    <span class="past-more">${more.join(", ")}</span>
  `;
}

function eventList(past: Past): TemplateResult | null {
  if (past.events.length === 0) {
    return null;
  }
  return html`
    <h3>Events</h3>
    <ul class="past-list" id="past-events">
      ${past.events.map(
        (event) => html`<li>
          <button type="button" @click=${() => void past.chooseEvent(event)}>
            ${eventText(event)}
          </button>
        </li>`,
      )}
    </ul>
  `;
}

function eventText({ t, until, kind, name, count }: PastEvent): TemplateResult {
  const lasted = until === null ? 0 : (Date.parse(until) - Date.parse(t)) / 1000;
  const about = kind === "mode" ? (MODE_NAMES[name as PoseMode] ?? name) : name;
  const parts = [about, lasted < 1 ? "" : duration(lasted), (count ?? 1) < 2 ? "" : `${count}×`];
  return html`
    <span>${clockTime(Date.parse(t))} ${KINDS[kind] ?? kind}</span>
    <span class="past-more">${parts.filter((part) => part !== "").join(", ")}</span>
  `;
}

function files(past: Past): TemplateResult {
  return html`
    <div class="player-row" id="past-files">
      ${FORMS.map(
        (form) => html`<button type="button" @click=${() => void past.save(form)}>
          ${form === "geojson" ? "GeoJSON" : form.toUpperCase()}
        </button>`,
      )}
      <span class="player-span">of this stretch</span>
    </div>
  `;
}

function chooseDay(past: Past, event: Event): void {
  const [year, month, day] = (event.target as HTMLInputElement).value.split("-").map(Number);
  if (year !== undefined && month !== undefined && day !== undefined) {
    void past.chooseDay(startOfDay(new Date(year, month - 1, day).getTime()));
  }
}

function valueOf(event: Event): number {
  return Number((event.target as HTMLInputElement | HTMLSelectElement).value);
}

/** "2026-11-30" by the reader's clock, as a date field has it. */
function isoDay(ms: number): string {
  const date = new Date(ms);
  const two = (value: number): string => `${value}`.padStart(2, "0");
  return `${date.getFullYear()}-${two(date.getMonth() + 1)}-${two(date.getDate())}`;
}
