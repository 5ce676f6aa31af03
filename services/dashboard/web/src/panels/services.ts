// Services up, down and in want of something: the vehicle's own, then the fleet's.

import { html } from "lit-html";
import type { TemplateResult } from "lit-html";

import type { Now } from "../clock";
import { serviceTone, servicesInWords } from "../health";
import type { Missing, Service } from "../view";
import { rate, since } from "../words";

/** `isKnown`: the bus tells of services; without it their last state says nothing. */
export function servicesPanel(
  services: Service[],
  isKnown: boolean,
  now: Now,
): TemplateResult | null {
  if (services.length === 0) {
    return null;
  }
  return html`
    <section id="services" aria-labelledby="services-title">
      <h2 id="services-title">
        Services <span class="count">${servicesInWords(services, isKnown)}</span>
      </h2>
      <ul>
        ${services.map((service) => row(service, isKnown, now))}
      </ul>
    </section>
  `;
}

function row(service: Service, isKnown: boolean, now: Now): TemplateResult {
  return html`
    <li>
      <span class="lamp ${serviceTone(service, isKnown)}"></span>
      <span class="service-name">${service.service}</span>
      <span class="service-state">${isKnown ? state(service) : "not known"}</span>
      ${service.up || !isKnown ? service.missing.map((each) => lack(each, now)) : null}
    </li>
  `;
}

function lack({ what, since: from }: Missing, now: Now): TemplateResult {
  return html`<span class="service-lack">${what}, ${since(Date.parse(from), now.serverMs)}</span>`;
}

function state(service: Service): string {
  if (!service.up) {
    return "down";
  }
  const parts = [];
  if (service.out_rate_hz !== null && service.out_rate_hz > 0) {
    parts.push(rate(service.out_rate_hz));
  }
  if (service.lag_ms_p99 !== null) {
    parts.push(`${Math.round(service.lag_ms_p99)} ms`);
  }
  if (service.dropped_rate_hz > 0) {
    parts.push(`drops ${rate(service.dropped_rate_hz)}`);
  }
  if (service.bad_input_rate_hz > 0) {
    parts.push(`refuses ${rate(service.bad_input_rate_hz)}`);
  }
  if (parts.length === 0) {
    return service.missing.length > 0 ? "waiting" : "up";
  }
  return parts.join(" · ");
}
