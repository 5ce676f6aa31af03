// What is said over the page while the line is not open.

import { html } from "lit-html";
import type { TemplateResult } from "lit-html";

import type { LineState } from "../connection";

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
