// A caller's contact as the laws of contact/ know it.
#pragma once

#include "kernel/force_law.h"
#include "world/refusal.h"

// Fails as jp_contact_check does.
// Writes the elastic part of a law into a contact.
void contact_set_elastic(const ForceLaw *law, JpContact *contact);

JpStatus contact_law(const JpContact *contact, ForceLaw *law, JpError *error);
