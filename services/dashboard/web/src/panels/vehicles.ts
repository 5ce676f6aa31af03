// The list of vehicles, when there are several.

import { html } from "lit-html";
import type { TemplateResult } from "lit-html";
import { repeat } from "lit-html/directives/repeat.js";

import { ageS } from "../clock";
import type { Now } from "../clock";
import type { Vehicle } from "../fleet";
import { isStale, vehicleTone } from "../health";
import { MODE_NAMES, UNKNOWN, duration, speedKmh } from "../words";

export function vehicleList(
  vehicles: Iterable<Vehicle>,
  selected: string | null,
  now: Now,
  choose: (vehicleId: string) => void,
): TemplateResult | null {
  const sorted = [...vehicles].sort((a, b) => a.vehicle_id.localeCompare(b.vehicle_id));
  if (sorted.length < 2) {
    return null;
  }
  return html`
    <nav id="vehicles" aria-label="Vehicles">
      <ul>
        ${repeat(
          sorted,
          (vehicle) => vehicle.vehicle_id,
          (vehicle) => html`
            <li>
              <button
                type="button"
                aria-current=${vehicle.vehicle_id === selected ? "true" : "false"}
                @click=${() => choose(vehicle.vehicle_id)}
              >
                <span class="lamp ${vehicleTone(vehicle, now)}"></span>
                <span class="vehicle-id">${vehicle.vehicle_id}</span>
                <span class="vehicle-state">${state(vehicle, now)}</span>
              </button>
            </li>
          `,
        )}
      </ul>
    </nav>
  `;
}

function state(vehicle: Vehicle, now: Now): string {
  const age = ageS(vehicle, now);
  if (vehicle.pose === undefined || age === null) {
    return UNKNOWN;
  }
  const speed = `${speedKmh(vehicle.pose.speed_mps)} km/h`;
  return isStale(vehicle, now)
    ? `silent for ${duration(age)}`
    : `${MODE_NAMES[vehicle.pose.mode]}, ${speed}`;
}
