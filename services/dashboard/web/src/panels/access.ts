// Asks for the token where the server wants one.

import { html } from "lit-html";
import type { TemplateResult } from "lit-html";

export function accessForm(triedBefore: boolean, enter: (token: string) => void): TemplateResult {
  const submit = (event: SubmitEvent): void => {
    event.preventDefault();
    const token = new FormData(event.target as HTMLFormElement).get("token");
    if (typeof token === "string" && token !== "") {
      enter(token.trim());
    }
  };
  return html`
    <form class="access" aria-labelledby="access-title" @submit=${submit}>
      <h2 id="access-title">This dashboard needs a token</h2>
      <label for="token">Access token</label>
      <input
        id="token"
        name="token"
        type="password"
        autocomplete="current-password"
        required
        autofocus
      />
      ${triedBefore ? html`<p class="warning" role="alert">That token is not accepted.</p>` : null}
      <button type="submit">Open</button>
    </form>
  `;
}
