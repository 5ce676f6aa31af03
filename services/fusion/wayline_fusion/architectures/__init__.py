"""The ways to bring fixes and dead reckoning together; `[tuning] architecture` names one."""
