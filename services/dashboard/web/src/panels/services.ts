// Services up and down: the vehicle's own, then the fleet's.

import { html } from "lit-html";
import type { TemplateResult } from "lit-html";

import { serviceTone } from "../health";
import type { Service } from "../view";

export function servicesPanel(own: Service[], shared: Service[]): TemplateResult | null {
  const all = [...own, ...shared];
  if (all.length === 0) {
    return null;
  }
  const down = all.filter((service) => !service.up).length;
  return html`
    <section id="services" aria-labelledby="services-title">
      <h2 id="services-title">
        Services <span class="count">${down === 0 ? "all up" : `${down} down`}</span>
      </h2>
      <ul>
        ${all.map(row)}
      </ul>
    </section>
  `;
}

function row(service: Service): TemplateResult {
  return html`
    <li title=${service.detail ?? ""}>
      <span class="lamp ${serviceTone(service)}"></span>
      <span class="service-name">${service.service}</span>
      <span class="service-state">${state(service)}</span>
    </li>
  `;
}

function state(service: Service): string {
  if (!service.up) {
    return "down";
  }
  const parts = [];
  if (service.out_rate_hz !== null && service.out_rate_hz > 0) {
    parts.push(`${service.out_rate_hz.toFixed(service.out_rate_hz < 10 ? 1 : 0)}/s`);
  }
  if (service.lag_ms_p99 !== null) {
    parts.push(`${Math.round(service.lag_ms_p99)} ms`);
  }
  if (service.dropped > 0) {
    parts.push(`${service.dropped} dropped`);
  }
  if (service.bad_input > 0) {
    parts.push(`${service.bad_input} bad`);
  }
  return parts.length === 0 ? "up" : parts.join(" · ");
}
