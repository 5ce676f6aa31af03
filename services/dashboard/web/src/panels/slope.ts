// The slope of the road ahead as a small chart with its uncertainty.

import { html, svg } from "lit-html";
import type { SVGTemplateResult, TemplateResult } from "lit-html";

import { slopeChart } from "../chart";
import type { Chart, Plot } from "../chart";
import type { Vehicle } from "../fleet";
import { length, signed } from "../words";

export const PLOT: Plot = { width: 340, height: 130, left: 38, right: 8, top: 10, bottom: 22 };

export function slopePanel(vehicle: Vehicle): TemplateResult | null {
  const { horizon } = vehicle;
  if (horizon === undefined) {
    return null;
  }
  const chart = slopeChart(horizon.points, PLOT);
  return html`
    <section id="slope" aria-labelledby="slope-title">
      <h2 id="slope-title">Slope ahead</h2>
      ${chart === null ? html`<p class="empty">Nobody has driven here before.</p>` : drawing(chart)}
    </section>
  `;
}

function drawing(chart: Chart): TemplateResult {
  const { lowPct, highPct, lengthM, runs } = chart;
  const summary = `From ${signed(lowPct, 1)} to ${signed(highPct, 1)} % over ${length(lengthM)}`;
  const known = `${runs} ${runs === 1 ? "run" : "runs"}`;
  return html`
    <svg viewBox="0 0 ${PLOT.width} ${PLOT.height}" role="img" aria-label="${summary}, ${known}">
      ${axes(chart)} ${chart.bands.map((points) => svg`<polygon class="band" points=${points} />`)}
      ${chart.lines.map((points) => svg`<polyline class="grade" points=${points} />`)}
    </svg>
    <p class="caption">${summary}; band ±1σ; ${known}</p>
  `;
}

function axes({ gradeTicks, distanceTicks }: Chart): SVGTemplateResult {
  const right = PLOT.width - PLOT.right;
  const bottom = PLOT.height - PLOT.bottom;
  return svg`
    ${gradeTicks.map(
      ({ at, value }) => svg`
        <line class=${value === 0 ? "axis" : "rule"} x1=${PLOT.left} x2=${right} y1=${at} y2=${at} />
        <text class="tick" x=${PLOT.left - 6} y=${at + 3.5} text-anchor="end">${signed(value, 0)} %</text>`,
    )}
    ${distanceTicks.map(
      ({ at, value }, index) => svg`
        <line class="axis" x1=${at} x2=${at} y1=${bottom} y2=${bottom + 3} />
        <text class="tick" x=${at} y=${bottom + 15} text-anchor=${
          index === distanceTicks.length - 1 ? "end" : "middle"
        }>${length(value)}</text>`,
    )}
  `;
}
