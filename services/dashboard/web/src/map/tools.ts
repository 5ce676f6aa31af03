// The buttons and the legend over the map.

import { html } from "lit-html";
import type { TemplateResult } from "lit-html";

export interface MapActions {
  follow(): void;
  overview(): void;
}

/** Where the page is a phone's, the legend would cover the map. */
const wide = window.matchMedia("(width >= 760px)").matches;

export function mapTools(following: boolean, actions: MapActions): TemplateResult {
  return html`
    <div class="buttons">
      <button
        id="follow"
        type="button"
        aria-pressed=${following ? "true" : "false"}
        @click=${() => actions.follow()}
      >
        ${following ? "Following" : "Follow"}
      </button>
      <button id="overview" type="button" @click=${() => actions.overview()}>Overview</button>
    </div>
    <details class="legend" ?open=${wide}>
      <summary>Legend</summary>
      <ul>
        <li><span class="key key-vehicle"></span>vehicle and heading</li>
        <li><span class="key key-ellipse"></span>within, at 95 %</li>
        <li><span class="key key-fix"></span>raw GPS fix</li>
        <li><span class="key key-trail"></span>trail</li>
        <li><span class="key key-reckoned"></span>trail without GPS</li>
        <li><span class="key key-stop"></span>stop</li>
      </ul>
    </details>
  `;
}
