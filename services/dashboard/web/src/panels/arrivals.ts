// The next arrivals of the selected vehicle.

import { html } from "lit-html";
import type { TemplateResult } from "lit-html";

import { vehicleNowMs } from "../clock";
import type { Now } from "../clock";
import type { Vehicle } from "../fleet";
import type { Stop } from "../view";
import { clockRange, countdown, length } from "../words";
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
    ${isOld ? html`<p class="warning">Predicted from an old position.</p>` : null}
    <ol class=${isOld ? "stops stale" : "stops"}>
      ${arrivals.stops.map((stop) => stopRow(stop, vehicleNow))}
    </ol>
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
      <strong class="countdown">${countdown((arrival - vehicleNow) / 1000)}</strong>
      <span class="stop-distance">${length(stop.distance_m)} ahead</span>
      <span class="range" title="The vehicle arrives between these with a probability of 80 %">
        ${clockRange(early, late)}
      </span>
    </li>
  `;
}
