// What is said over the page while the line is not open, or the bus behind it is gone.

import { html } from "lit-html";
import type { TemplateResult } from "lit-html";

import type { Now } from "../clock";
import type { LineState } from "../connection";
import type { Missing } from "../view";
import { duration } from "../words";

/** What is said while the server is there and hears nobody. */
export function busBanner(gone: Missing, now: Now): TemplateResult {
  const seconds = Math.max(0, (now.serverMs - Date.parse(gone.since)) / 1000);
  return html`
    <p class="lost">
      The bus is gone: what you see is old, and no service is known to be up or down.
      <span aria-hidden="true">For ${duration(seconds)}.</span>
    </p>
  `;
}

/** `wasOpen`: what is on the page was live once and is now growing old. */
export function banner(
  state: LineState,
  wasOpen: boolean,
  nowMonotonicMs: number,
  tryNow: () => void,
): TemplateResult | null {
  if (state.kind === "open" || state.kind === "refused") {
    return null;
  }
  if (state.kind === "connecting") {
    return wasOpen ? html`<p class="lost">Connection lost. Connecting again…</p>` : null;
  }
  const seconds = Math.max(1, Math.ceil((state.retryAtMs - nowMonotonicMs) / 1000));
  const what = wasOpen ? "Connection lost: what you see is old." : "The server does not answer.";
  return html`
    <p class="lost">
      ${what} <span aria-hidden="true">Trying again in ${seconds} s.</span>
      <button type="button" @click=${tryNow}>Try now</button>
    </p>
  `;
}
