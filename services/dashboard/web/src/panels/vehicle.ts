// The selected vehicle: how it is located and what it does.

import { html } from "lit-html";
import type { TemplateResult } from "lit-html";

import { ageS, isRecording, vehicleNowMs } from "../clock";
import type { Now } from "../clock";
import type { Vehicle } from "../fleet";
import { SIGMAS_95 } from "../geometry";
import { isStale, vehicleTone } from "../health";
import {
  MODE_MEANINGS,
  MODE_NAMES,
  UNKNOWN,
  accuracy,
  compassPoint,
  dateAndTime,
  duration,
  heading,
  signed,
  speedKmh,
} from "../words";

const PRESENT_MS = 60_000;

export function vehiclePanel(vehicle: Vehicle, now: Now): TemplateResult {
  const { pose } = vehicle;
  return html`
    <section id="vehicle" aria-labelledby="vehicle-title">
      <div class="title-row">
        <h2 id="vehicle-title">${vehicle.vehicle_id}</h2>
        ${modeBadge(vehicle, now)}
      </div>
      <p class="age" id="age">${age(vehicle, now)}</p>
      <dl class="readings">
        ${reading("Speed", speedKmh(pose?.speed_mps), "km/h")}
        ${reading("Heading", heading(pose?.heading_deg), compassPoint(pose?.heading_deg))}
        ${reading("Within", within(vehicle), "at 95 %")}
        ${reading("Slope", signed(pose?.grade_pct, 1), slopeUnit(pose?.grade_std_pct))}
      </dl>
    </section>
  `;
}

function modeBadge(vehicle: Vehicle, now: Now): TemplateResult {
  const mode = vehicle.pose?.mode;
  const name = mode === undefined ? "No position" : MODE_NAMES[mode];
  const meaning = mode === undefined ? "" : MODE_MEANINGS[mode];
  return html`<span id="mode" class="badge ${vehicleTone(vehicle, now)}" title=${meaning}
    >${name}</span
  >`;
}

function age(vehicle: Vehicle, now: Now): TemplateResult {
  const seconds = ageS(vehicle, now);
  if (seconds === null) {
    return html`no pose received yet`;
  }
  const text = isStale(vehicle, now)
    ? html`<strong class="silent">silent for ${duration(seconds)}</strong>`
    : html`updated ${duration(seconds)} ago`;
  return isRecording(vehicle) ? html`${text} · ${recording(vehicle, now)}` : text;
}

/** With its own time where that is not the present: the demo's recordings are played as of now. */
function recording(vehicle: Vehicle, now: Now): string {
  const vehicleNow = vehicleNowMs(vehicle, now);
  const isPresent = Math.abs(now.serverMs - vehicleNow) < PRESENT_MS;
  return isPresent ? "recording" : `recording of ${dateAndTime(vehicleNow)}`;
}

function reading(name: string, value: string, unit: string): TemplateResult {
  return html`<div>
    <dt>${name}</dt>
    <dd><b>${value}</b> <span>${value === UNKNOWN ? "" : unit}</span></dd>
  </div>`;
}

function within(vehicle: Vehicle): string {
  const ellipse = vehicle.pose?.ellipse;
  return ellipse == null ? UNKNOWN : `${accuracy(SIGMAS_95 * ellipse.semi_major_m)}`;
}

function slopeUnit(std_pct: number | null | undefined): string {
  return std_pct == null ? "%" : `% ±${std_pct.toFixed(1)}`;
}
