// The next arrivals of the selected vehicle.

import { html } from "lit-html";
import type { TemplateResult } from "lit-html";

import { vehicleNowMs } from "../clock";
import type { Now } from "../clock";
import type { Vehicle } from "../fleet";
import type { Stop } from "../view";
import { clockRange, clockTime, countdown, countdownRange, lateness, length } from "../words";
import { routeNote } from "./positioning";

/** They come every second; the eta service says itself when the position is old, if it can. */
const OLD_MS = 10_000;

export function arrivalsPanel(
  vehicle: Vehicle,
  now: Now,
  routeNames: ReadonlyMap<string, string>,
): TemplateResult {
  const note = routeNote(vehicle, routeNames);
  return html`
    <section id="arrivals" aria-labelledby="arrivals-title">
      <h2 id="arrivals-title">Arrivals</h2>
      ${note === null ? null : html`<p class="caption">${note}</p>`} ${content(vehicle, now)}
    </section>
  `;
}

function content(vehicle: Vehicle, now: Now): TemplateResult {
  const { arrivals, progress } = vehicle;
  if (arrivals === undefined) {
    return html`<p class="empty">No route is followed.</p>`;
  }
  if (arrivals.stops.length === 0) {
    const reason =
      progress?.on_route === false ? "The vehicle is off its route." : "None to predict.";
    return html`<p class="empty">${reason}</p>`;
  }
  const vehicleNow = vehicleNowMs(vehicle, now);
  const isOld = arrivals.stale || vehicleNow - Date.parse(arrivals.t) > OLD_MS;
  return html`
    ${trip(vehicle)} ${isOld ? html`<p class="warning">Predicted from an old position.</p>` : null}
    <ol class=${isOld ? "stops stale" : "stops"}>
      ${arrivals.stops.map((stop) => stopRow(stop, vehicleNow))}
    </ol>
  `;
}

/** Where the trip goes, and how it keeps its time; nothing of a route without a timetable. */
function trip({ arrivals, progress }: Vehicle): TemplateResult | null {
  if (arrivals === undefined || arrivals.trip_id === null) {
    return null;
  }
  const delay = progress?.delay_s ?? null;
  return html`
    <p class="trip">
      <strong>${arrivals.headsign ?? arrivals.route_id}</strong>
      <span class="trip-id">trip ${arrivals.trip_id}</span>
      ${delay === null ? null : html`<span class="lateness">${lateness(delay)}</span>`}
    </p>
  `;
}

function stopRow(stop: Stop, vehicleNow: number): TemplateResult {
  const [arrival, early, late] = [stop.arrival, stop.early, stop.late].map(Date.parse) as [
    number,
    number,
    number,
  ];
  return html`
    <li>
      <span class="stop-name">${stop.name}</span>
      <span class="when">
        <strong class="countdown">${countdown((arrival - vehicleNow) / 1000)}</strong>
        <span class="range" title="${clockRange(early, late)} with a probability of 80 %">
          ${countdownRange((early - vehicleNow) / 1000, (late - vehicleNow) / 1000)}
        </span>
      </span>
      <span class="stop-distance">${length(stop.distance_m)} ahead</span>
      <span class="clock">${clockTime(arrival)}</span>
      ${timetable(stop)}
    </li>
  `;
}

function timetable(stop: Stop): TemplateResult | null {
  if (stop.scheduled === null || stop.delay_s === null) {
    return null;
  }
  return html`
    <span class="scheduled">
      ${clockTime(Date.parse(stop.scheduled))} by timetable, ${lateness(stop.delay_s)}
    </span>
  `;
}
