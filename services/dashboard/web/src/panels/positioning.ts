// What the position rests on: the receiver, the sensors, what was refused.

import { html } from "lit-html";
import type { TemplateResult } from "lit-html";

import type { Vehicle } from "../fleet";
import type { SensorSlope, Status } from "../view";
import { duration, length, signed } from "../words";

const SENSORS: Record<string, string> = {
  gps_altitude: "GPS altitude",
  barometer: "Barometer",
  torque: "Torque",
  vehicle_slope: "The vehicle's own",
};

export function positioningPanel(vehicle: Vehicle): TemplateResult | null {
  const lines = [outageNote(vehicle), fixNote(vehicle), calibrationNote(vehicle)];
  const told = lines.filter((line) => line !== null);
  if (told.length === 0) {
    return null;
  }
  return html`
    <section id="positioning" aria-labelledby="positioning-title">
      <h2 id="positioning-title">Positioning</h2>
      <ul>
        ${told.map((line) => html`<li>${line}</li>`)}
      </ul>
      ${slopesBySensor(vehicle.status?.slopes ?? [])}
    </section>
  `;
}

/** What each sensor alone says of the road just driven, beside the one slope that fusion tells. */
function slopesBySensor(slopes: readonly SensorSlope[]): TemplateResult | null {
  if (slopes.length === 0) {
    return null;
  }
  const receivers = slopes.filter((slope) => slope.source !== null).length;
  return html`
    <details id="slopes">
      <summary>Slope of the last 200 m by sensor</summary>
      <dl>
        ${slopes.map(
          (slope) => html`
            <dt>
              ${SENSORS[slope.sensor] ?? slope.sensor}${receivers > 1 && slope.source !== null
                ? ` (${slope.source})`
                : ""}
            </dt>
            <dd>
              ${signed(slope.slope_pct, 1)} ± ${slope.slope_std_pct.toFixed(1)}
              %${slope.refused ? ", refused" : ""}
            </dd>
          `,
        )}
      </dl>
    </details>
  `;
}

/** Where the vehicle is along its route, or how far off it. */
export function routeNote(
  { progress }: Vehicle,
  names: ReadonlyMap<string, string>,
): string | null {
  if (progress === undefined) {
    return null;
  }
  const name = names.get(progress.route_id) ?? progress.route_id;
  const lap = progress.lap > 0 ? `, lap ${progress.lap + 1}` : "";
  return progress.on_route
    ? `${name}: ${length(progress.distance_m)} along it${lap}`
    : `Off ${name} by ${length(Math.abs(progress.cross_track_m))}`;
}

function outageNote({ pose, status }: Vehicle): string | null {
  const reckons = pose?.mode === "dead_reckoning" || pose?.mode === "lost";
  return reckons && status !== undefined
    ? `No accepted fix for ${duration(status.outage_s)}`
    : null;
}

function fixNote({ fix }: Vehicle): string | null {
  if (fix === undefined) {
    return null;
  }
  if (!fix.valid) {
    return "Receiver: no fix";
  }
  const kind = fix.fix.replace("_", " ").toUpperCase();
  const satellites = fix.satellites === null ? "" : `, ${fix.satellites} satellites`;
  const hdop = fix.hdop === null ? "" : `, HDOP ${fix.hdop.toFixed(1)}`;
  return `Receiver: ${kind}${satellites}${hdop}`;
}

const CALIBRATIONS = {
  none: "Wheels and gyro: not calibrated",
  started: "Wheels and gyro: calibrating",
  calibrated: "Wheels and gyro: calibrated",
} as const;

function calibrationNote({ pose, status }: Vehicle): string | null {
  // without CAN there is nothing to calibrate
  if (status === undefined || pose?.mode === "gps" || pose?.mode === "starting") {
    return null;
  }
  const rejected =
    status.rejected > 0 ? `; ${status.rejected} measurements refused${lastRejection(status)}` : "";
  return CALIBRATIONS[status.calibration] + rejected;
}

function lastRejection({ last_rejection: last }: Status): string {
  return last === null ? "" : `, last ${last.replaceAll("_", " ")}`;
}
